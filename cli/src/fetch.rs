//! Bringing a sweep's results to files.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use clap::{Args, ValueEnum};
use drillsweep_api::{ArtifactEntry, ArtifactList, PointDetail, Sweep};
use drillsweep_quantity::columns::ORBIT_MEAN_RADIUS;
use drillsweep_quantity::{ChoiceError, Name, Place, UnitChoice, UnitSystem, Variant};
use drillsweep_table::tables::{self, Layout};
use indicatif::ProgressBar;
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::client::{Client, ServerArguments, path_segment};
use crate::print;

/// Tables of one point.
static TABLES: [&Layout; 9] = [
    &tables::PROFILE,
    &tables::STATICS,
    &tables::HISTORY,
    &tables::COURSE,
    &tables::SNAPSHOTS,
    &tables::LINES,
    &tables::CONTACTS,
    &tables::LOADS,
    &tables::ENERGY,
];

#[derive(Args)]
pub(crate) struct FetchArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// Directory to write to; made if it does not exist.
    #[arg(long, value_name = "DIRECTORY", default_value = "results")]
    output: PathBuf,
    /// Format of the files.
    #[arg(long, value_enum, default_value = "parquet")]
    format: Format,
    /// Units of the columns: `si`, `field`, and `COLUMN:UNIT` for single columns, separated by commas. Names of files then end in `-si`, `-field` or
    /// `-units`; CSV has units in its first line.
    #[arg(long, value_parser = Units::parse)]
    units: Option<Units>,
    /// Signs of weight on bit and torque on bit in the sweep's table: `driller` has compression, and torque that opposes clockwise rotation, as
    /// positive.
    #[arg(long, default_value = "model", value_parser = ["model", "driller"])]
    signs: String,
    /// Download the sweep's table only.
    #[arg(long)]
    table_only: bool,
    /// Succeed although points have no result yet: present results are fetched either way, and another fetch adds the rest.
    #[arg(long)]
    partial: bool,
    /// Print the names of the files as JSON instead of the directory's.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Csv,
    Json,
    Parquet,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Parquet => "parquet",
        }
    }
}

/// Units of the columns, as they were written.
#[derive(Clone)]
pub(crate) struct Units {
    text: String,
    pub(crate) choice: UnitChoice,
}

impl Units {
    pub(crate) fn parse(text: &str) -> Result<Self, ChoiceError> {
        Ok(Self { text: text.to_owned(), choice: UnitChoice::parse(text)? })
    }
}

/// Format and units of the files.
struct Form<'a> {
    format: &'static str,
    units: Option<&'a Units>,
}

impl Form<'_> {
    /// Query that requests it.
    fn query(&self) -> String {
        match self.units {
            Some(units) => format!("format={}&units={}", self.format, path_segment(&units.text)),
            None => format!("format={}", self.format),
        }
    }

    /// End of the names of its files.
    fn ending(&self) -> String {
        match self.units.and_then(|units| units.choice.suffix()) {
            Some(suffix) => format!("-{suffix}.{}", self.format),
            None => format!(".{}", self.format),
        }
    }

    /// True if another choice of units may have files of the same names.
    fn is_ambiguous(&self) -> bool {
        self.units.is_some_and(|units| {
            ![UnitSystem::Si, UnitSystem::Field].map(UnitChoice::from).contains(&units.choice)
        })
    }
}

/// Writes `sweep.json` as the server describes the sweep, `table` with a row a point, and a folder a point with its tables and full
/// spectra. A file that the server cannot give does not stop the others: `missing.json` lists missing files with the reasons, and the
/// command fails. Files of points that have not changed since the last fetch are kept, so an interrupted fetch resumes.
pub(crate) fn fetch(arguments: &FetchArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = &path_segment(&client.sweep_id(&arguments.sweep)?);
    let sweep: Sweep = client.get(&format!("/v1/sweeps/{id}"))?;
    let form = &Form { format: arguments.format.name(), units: arguments.units.as_ref() };
    std::fs::create_dir_all(&arguments.output)
        .with_context(|| format!("cannot make {}", arguments.output.display()))?;
    let mut files = Files::default();
    let own = arguments.output.join(SWEEP_FILE);
    refuse_another_sweeps(&own, &sweep)?;
    files.write(own, serde_json::to_string_pretty(&sweep)?.as_bytes())?;
    let signs = if arguments.signs == "driller" { "&signs=driller" } else { "" };
    let table = client.bytes(&format!("/v1/sweeps/{id}/table?{}{signs}", form.query()))?;
    files.write(arguments.output.join(format!("table{}", form.ending())), &table)?;
    if !arguments.table_only {
        points(&client, &sweep, &arguments.output, form, &mut files)?;
    }
    let manifest = arguments.output.join("missing.json");
    if files.missing.is_empty() {
        // An earlier try may have found less.
        if manifest.exists() {
            std::fs::remove_file(&manifest)
                .with_context(|| format!("cannot remove {}", manifest.display()))?;
        }
    } else {
        let missing = serde_json::to_string_pretty(&files.missing)?;
        files.write(manifest, missing.as_bytes())?;
    }
    if arguments.json {
        print(&serde_json::to_string_pretty(&json!(files.written))?);
    } else {
        print(&format!("{}", arguments.output.display()));
    }
    ensure!(
        files.missing.is_empty(),
        "{} files are missing; missing.json lists them with the reasons",
        files.missing.len()
    );
    let open = sweep.counts.queued + sweep.counts.running;
    if open > 0 {
        let text = format!("{open} of {} points have no result yet", sweep.counts.total);
        ensure!(arguments.partial, "{text}; fetch again later, or fetch the present results by --partial");
        tracing::warn!("{text}");
    }
    Ok(())
}

/// The sweep that a directory's files are of.
const SWEEP_FILE: &str = "sweep.json";

/// Keeps the points of two sweeps, whose folders have the same names, from being mixed.
fn refuse_another_sweeps(file: &Path, sweep: &Sweep) -> anyhow::Result<()> {
    let Ok(known) = std::fs::read(file) else { return Ok(()) };
    let known: Value = serde_json::from_slice(&known).unwrap_or_default();
    let directory = file.parent().unwrap_or(file).display();
    match known["id"].as_str() {
        Some(id) if id == sweep.id => Ok(()),
        Some(id) => bail!("{directory} has the results of sweep {id}; give another directory by --output"),
        None => bail!(
            "{} does not name the sweep of the files next to it; give another directory by --output",
            file.display()
        ),
    }
}

fn points(
    client: &Client,
    sweep: &Sweep,
    output: &Path,
    form: &Form<'_>,
    files: &mut Files,
) -> anyhow::Result<()> {
    let id = path_segment(&sweep.id);
    let total = sweep.counts.total;
    let bar = ProgressBar::new(total);
    for ordinal in 1..=total {
        let path = format!("/v1/sweeps/{id}/points/{ordinal}");
        let point: PointDetail = client.get(&path)?;
        let folder = output.join(format!("point-{ordinal:04}"));
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        // Written last, it shows that the files next to it are of this result.
        let (mark, described) = (folder.join("point.json"), serde_json::to_string_pretty(&point)?);
        files.is_unchanged =
            !form.is_ambiguous() && std::fs::read(&mark).is_ok_and(|known| known == described.as_bytes());
        let has = |name: &str| point.tables.iter().any(|table| table == name);
        // Parquet is served as it is stored, and a long history in stretches.
        let stored: Vec<ArtifactEntry> =
            match form.format == Format::Parquet.name() && form.units.is_none() && !point.tables.is_empty() {
                true => client.get::<ArtifactList>(&format!("{path}/artifacts"))?.artifacts,
                false => Vec::new(),
            };
        for table in TABLES.iter().map(|table| table.name).filter(|table| has(table)) {
            let file = folder.join(format!("{table}{}", form.ending()));
            match stored.iter().find(|entry| entry.name == table && entry.expired.is_none()) {
                Some(entry) => files.download_stored(client, entry, file)?,
                None => files.download(client, &format!("{path}/{table}?{}", form.query()), file)?,
            }
        }
        if has("cost") {
            for extension in ["json", "csv", "svg", "png"] {
                let file = folder.join(format!("cost.{extension}"));
                files.download(client, &format!("{path}/cost?format={extension}"), file)?;
            }
        }
        if has(tables::HISTORY.name) || has(tables::SPECTRA.name) {
            for place in point.summary.iter().flat_map(recorded_places) {
                let bit = point.scenario.string.depth_of_bit();
                let (query, place) = match (place.depth(), place.height()) {
                    (Some(depth), _) => (format!("depth={depth}"), format!("{depth}m")),
                    (None, Some(height)) => {
                        (format!("depth={}", bit - height), format!("{height}m-above-bit"))
                    }
                    (None, None) => {
                        let node = place.node().unwrap_or_default();
                        (format!("node={node}"), format!("node{node}"))
                    }
                };
                let node_and_form = format!("{query}&window=hann&{}", form.query());
                let Some(windows) = point.scenario.spectrum_windows() else {
                    // Runs that settle keep only their window.
                    let name = format!("spectrum-{place}{}", form.ending());
                    files.download(client, &format!("{path}/spectrum?{node_and_form}"), folder.join(name))?;
                    continue;
                };
                for window in windows {
                    let (from, to) = (json!(window.from), json!(window.to));
                    let query = format!("{node_and_form}&from={from}&to={to}");
                    let name = format!("spectrum-{place}-{from}-{to}s{}", form.ending());
                    files.download(client, &format!("{path}/spectrum?{query}"), folder.join(name))?;
                }
            }
        }
        files.write(mark, described.as_bytes())?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

/// The nodes that a summary has orbits of, by number or depth.
fn recorded_places(summary: &Map<String, Value>) -> impl Iterator<Item = Place<'_>> {
    let of_orbit = |name: &Name<'_>| name.quantity == &ORBIT_MEAN_RADIUS && name.variant == Variant::Value;
    summary.keys().filter_map(move |name| Name::parse(name).filter(of_orbit)?.place)
}

/// The files as they are written, and those that cannot be had.
#[derive(Default)]
struct Files {
    written: Vec<PathBuf>,
    missing: Vec<Missing>,
    /// True if the present files of this point are those that the server has.
    is_unchanged: bool,
}

/// A file that the server could not give.
#[derive(Serialize)]
struct Missing {
    file: PathBuf,
    reason: String,
}

impl Files {
    /// Writes what the server answers; a problem that it answers with is noted.
    fn download(&mut self, client: &Client, path: &str, file: PathBuf) -> anyhow::Result<()> {
        if self.has(&file) {
            self.written.push(file);
            return Ok(());
        }
        match client.file(path)? {
            Ok(bytes) => self.write(file, &bytes),
            Err(reason) => {
                self.missing.push(Missing { file, reason });
                Ok(())
            }
        }
    }

    /// The same of a table as it is stored.
    fn download_stored(
        &mut self,
        client: &Client,
        entry: &ArtifactEntry,
        file: PathBuf,
    ) -> anyhow::Result<()> {
        if self.has(&file) {
            self.written.push(file);
            return Ok(());
        }
        match client.stored_table(entry, &file)? {
            Ok(()) => self.written.push(file),
            Err(reason) => self.missing.push(Missing { file, reason }),
        }
        Ok(())
    }

    /// True if a file need not be downloaded. An empty one must be: the machine lost power before its bytes were on the disk.
    fn has(&self, file: &Path) -> bool {
        self.is_unchanged && file.metadata().is_ok_and(|metadata| metadata.len() > 0)
    }

    fn write(&mut self, path: PathBuf, bytes: &[u8]) -> anyhow::Result<()> {
        // Under another name first: what has its name is whole.
        let part = path.with_added_extension("part");
        std::fs::write(&part, bytes)
            .and_then(|()| std::fs::rename(&part, &path))
            .with_context(|| format!("cannot write {}", path.display()))?;
        self.written.push(path);
        Ok(())
    }
}
