//! Whether what a data directory holds is whole.

use anyhow::ensure;
use clap::Args;
use drillsweep_store::{Role, Store};
use serde_json::json;

use crate::print;
use crate::service::DataArguments;

#[derive(Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    data: DataArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Reads the database and every blob, and fails if something is wrong with them.
pub(crate) fn check(arguments: &CheckArguments) -> anyhow::Result<()> {
    let config = arguments.data.existing_store(Role::Worker)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let report = runtime.block_on(async {
        let store = Store::open(&config).await?;
        let report = store.check().await;
        store.close().await;
        report
    })?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&json!({
            "results": report.results,
            "blobs": report.blobs,
            "bytes": report.bytes,
            "problems": report.problems,
        }))?);
    } else {
        print(&format!("{} results, {} blobs of {} bytes", report.results, report.blobs, report.bytes));
        for problem in &report.problems {
            print(&format!("  {problem}"));
        }
    }
    ensure!(report.problems.is_empty(), "{} problems were found", report.problems.len());
    Ok(())
}
