use std::fmt::Write as _;

use drillsweep_scenario::Grade;

use super::*;
use crate::grid::tests::workbook;
use crate::{MOST_BYTES, MOST_PROBLEMS};

/// Assembly of a published 12 1/4 in tally (Open-Source-Drilling-Community, Dixit-Drillstring-Model-2023, sheet `back_up`) from the top: length
/// \[m\], weight in air \[lbf\], outer and inner diameter \[mm\].
const PUBLISHED: [(&str, f64, f64, f64, f64); 10] = [
    ("transition collar", 9.32, 6759.0, 244.0, 77.0),
    ("filter sub", 2.53, 1841.0, 246.0, 82.0),
    ("float sub", 1.14, 816.0, 241.0, 72.0),
    ("12 1/8 NM string stabilizer", 1.56, 974.0, 242.0, 77.0),
    ("9.5\" NM pony", 3.68, 2670.0, 246.0, 83.0),
    ("Telescope 950 (MWD)", 8.59, 5315.0, 233.0, 108.0),
    ("12 1/8 in-line stabilizer", 1.51, 942.0, 241.0, 102.0),
    ("ARC-9 (LWD)", 5.81, 3813.0, 233.0, 109.0),
    ("motor, 12 1/8 stabilizers", 8.65, 4497.0, 231.0, 171.45),
    ("12 1/4 PDC bit", 0.41, 349.0, 202.0, 72.0),
];

/// Its pipe: 200 joints of 9.5 m of 5 7/8 in with 191,778 lbf.
const PIPE: (f64, f64) = (1900.0, 191_778.0);

const POUND: f64 = 0.453_592_37;

fn read(text: &str) -> Tally {
    with(text, TallyOptions::default())
}

fn with(text: &str, options: TallyOptions<'_>) -> Tally {
    tally(text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str, options: TallyOptions<'_>) -> ImportError {
    tally(text.as_bytes(), options).expect_err(text)
}

/// The published tally as a sheet in German spelling, from the top.
fn published() -> String {
    let mut text = "Bohrgarnitur;;;;\nComponent;Length [m];Weight in air [lbf];OD [mm];ID [mm]\n".to_owned();
    let (length, weight) = PIPE;
    writeln!(text, "5 7/8 drillpipe;{length};{weight};149,225;128,143").unwrap();
    for (name, length, weight, outer, inner) in PUBLISHED {
        let row = format!("\"{}\";{length};{weight};{outer};{inner}", name.replace('"', "\"\""));
        let (name, numbers) = row.split_at(row.rfind("\";").unwrap());
        writeln!(text, "{name}{}", numbers.replace('.', ",")).unwrap();
    }
    text
}

#[test]
fn the_weight_in_air_of_a_published_tally_is_its_own() {
    let tally = read(&published());
    assert!(tally.problems.is_empty(), "{:?}", tally.problems);
    assert_eq!(tally.order, TallyOrder::FromTop);
    let pounds = PIPE.1 + PUBLISHED.iter().map(|row| row.2).sum::<f64>();
    let metres = PIPE.0 + PUBLISHED.iter().map(|row| row.1).sum::<f64>();
    assert_eq!(pounds, 219_754.0);
    assert!((tally.mass.unwrap() / (pounds * POUND) - 1.0).abs() < 1e-12, "{:?}", tally.mass);
    assert!((tally.length - metres).abs() < 1e-9, "{}", tally.length);
    use SectionKind::{Bit, Collar, Drillpipe, Stabilizer};
    let kinds: Vec<_> = tally.components.iter().map(|component| component.kind).collect();
    let expected =
        [Drillpipe, Collar, Collar, Collar, Stabilizer, Collar, Collar, Stabilizer, Collar, Collar, Bit];
    assert_eq!(kinds, expected);
    assert!(tally.components.iter().all(|component| component.recognised_by.is_some()));
    let motor = &tally.sections[9];
    assert_eq!((motor.outer_diameter, motor.inner_diameter), (0.231, 0.171_45));
    // The bit of 12 1/4 in has a body of 202 mm, and no gauge in the file.
    assert_eq!(tally.sections[10].blade_diameter, None);
    assert_eq!(tally.components[10].remarks, ["the bit has no gauge above its body"]);
}

#[test]
fn one_tally_in_four_files_has_one_meaning() {
    let csv = "Description,Jts,Total Length (ft),Body OD (in),Body ID (in),Gauge OD (in),Weight (lb/ft),TJ OD (in),TJ ID (in),TJ Length (ft),Grade\n\
        PDC Bit,1,1.00,12.25,,,,,,,\n\
        Near bit stabilizer,1,5.00,8,2 13/16,12 1/8,150,,,,\n\
        8\" Drill collar,3,90.00,8,2 13/16,,150,,,,\n\
        5\" DP,10,310.00,5,4.276,,22.6,6 5/8,3 1/4,0.85,S-135\n";
    let metric = "Item;No. of joints;Length each (m);OD;ID;Blade OD (mm);Linear weight (kg/m);Tool joint OD (mm);Tool joint ID (mm);Tool joint length (m);Grade\n\
        Drillpipe 5\";10;9,4488;127 mm;108,6104 mm;;33,63250512;168,275;82,55;0,25908;S135\n\
        DC;3;9,144;8 in;2 13/16 in;;223,2245916;;;;\n\
        NB stab;1;1,524;203,2 mm;71,4375 mm;307,975;223,2245916;;;;\n\
        Bit;1;0,3048;311,15 mm;;;;;;;\n";
    let component = |sequence, kind, od, id: &str, len, weight: &str, more: &str| {
        format!(
            "<tubularComponent uid=\"{sequence}\"><typeTubularComp>{kind}</typeTubularComp><sequence>{sequence}</sequence>{id}\
             <od uom=\"in\">{od}</od><len uom=\"ft\">{len}</len>{weight}{more}</tubularComponent>"
        )
    };
    let id = |id: &str| format!("<id uom=\"in\">{id}</id>");
    let weight = |weight: &str| format!("<wtPerLen uom=\"lbm/ft\">{weight}</wtPerLen>");
    let pipe = "<grade>S-135</grade><lenJointAv uom=\"ft\">31</lenJointAv>\
        <connection><id uom=\"in\">3.25</id><od uom=\"in\">6.625</od><len uom=\"ft\">.85</len></connection>";
    let gauge = "<stabilizer><odBladeMx uom=\"in\">12.125</odBladeMx></stabilizer>";
    let collars = "<lenJointAv uom=\"m\">9.144</lenJointAv>";
    let components = [
        component(4, "drillpipe", 5, &id("4.276"), 310, &weight("22.6"), pipe),
        component(1, "bit PDC", 8, "", 1, "", "<bitRecord><diaBit uom=\"in\">12.25</diaBit></bitRecord>"),
        component(3, "drill collar", 8, &id("2.8125"), 90, &weight("150"), collars),
        component(2, "near bit stabilizer", 8, &id("2.8125"), 5, &weight("150"), gauge),
    ];
    let xml = format!(
        "<?xml version=\"1.0\"?>\n<tubulars xmlns=\"http://www.witsml.org/schemas/1series\" version=\"1.4.1.1\"><tubular uid=\"b\"><name>BHA 3</name>{}</tubular></tubulars>",
        components.concat()
    );
    let mut later = xml.replace("tubularComponent", "TubularComponent").replace("<tubular ", "<Tubular ");
    later =
        later.replace("</tubular>", "</Tubular>").replace("bitRecord", "BitRecord").replace("<id ", "<Id ");
    later = later.replace("</id>", "</Id>").replace("lenJointAv", "LenJointAv").replace("diaBit", "DiaBit");
    let files = [csv, metric, &xml, &later];
    let tallies: Vec<Tally> = files.iter().map(|file| read(file)).collect();
    for (tally, file) in tallies.iter().zip(files) {
        assert!(tally.problems.is_empty(), "{:?}: {file}", tally.problems);
        assert_eq!(tally.sections.len(), 4, "{file}");
        let inches = |metres: f64| metres / 0.0254;
        let expected = [
            (SectionKind::Drillpipe, 10, 31.0, 5.0, 4.276, None, Some(22.6)),
            (SectionKind::Collar, 3, 30.0, 8.0, 2.8125, None, Some(150.0)),
            (SectionKind::Stabilizer, 1, 5.0, 8.0, 2.8125, Some(12.125), Some(150.0)),
            (SectionKind::Bit, 1, 1.0, 8.0, 2.8125, Some(12.25), None),
        ];
        for (section, (kind, count, feet, outer, inner, blades, pounds)) in
            tally.sections.iter().zip(expected)
        {
            assert_eq!((section.kind, section.count), (kind, count), "{file}");
            let close = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-8;
            assert!(close(section.length / 0.3048, feet), "{}: {file}", section.length);
            assert!(close(inches(section.outer_diameter), outer), "{}: {file}", section.outer_diameter);
            assert!(close(inches(section.inner_diameter), inner), "{}: {file}", section.inner_diameter);
            let both = section.blade_diameter.map(inches).zip(blades);
            assert!(section.blade_diameter.is_some() == blades.is_some());
            assert!(both.is_none_or(|(found, blades)| close(found, blades)), "{both:?}: {file}");
            let both = section.mass_per_length.map(|mass| mass * 0.3048 / POUND).zip(pounds);
            assert!(section.mass_per_length.is_some() == pounds.is_some());
            assert!(both.is_none_or(|(found, pounds)| close(found, pounds)), "{both:?}: {file}");
        }
        let pipe = &tally.sections[0];
        let joint = pipe.tool_joint.unwrap();
        assert!((joint.outer_diameter - 0.168_275).abs() < 1e-12 && (joint.length - 0.259_08).abs() < 1e-12);
        assert_eq!(pipe.grade, Some(Grade::S135), "{file}");
    }
    let orders: Vec<_> = tallies.iter().map(|tally| tally.order).collect();
    use TallyOrder::{FromBit, FromTop};
    assert_eq!(orders, [FromBit, FromTop, FromBit, FromBit]);
    let filled: Vec<_> = tallies[0].components[3].remarks.iter().map(String::as_str).collect();
    assert_eq!(
        filled,
        [
            "the body has the outer diameter of the component above, 0.2032 m",
            "the body has the inner diameter of the component above, 0.0714375 m"
        ]
    );
}

#[test]
fn sections_are_those_of_a_scenario() {
    let mut scenario = drillsweep_scenario::preset("paper-200m").unwrap();
    scenario.string.sections = read(&published()).sections;
    let again = drillsweep_scenario::Scenario::from_toml(&scenario.to_toml()).unwrap();
    assert_eq!(again.string.sections, scenario.string.sections);
}

#[test]
fn a_workbook_is_read_by_its_sheet() {
    let rows: [&[&str]; 4] = [
        &["Component", "Length", "OD", "ID"],
        &["", "(m)", "(in)", "(in)"],
        &["Bit", "0.3", "6 3/4", "2.25"],
        &["Collar", "9", "6.75", "2 13/16"],
    ];
    let bytes = workbook(&[("Notes", &[&["text"]]), ("BHA", &rows)]);
    let wanted = TallyOptions { sheet: Some("bha"), ..TallyOptions::default() };
    let tally = super::tally(&bytes, wanted).unwrap();
    assert_eq!(tally.sections.iter().map(|section| section.length).collect::<Vec<_>>(), [9.0, 0.3]);
    assert!(matches!(super::tally(&bytes, TallyOptions::default()), Err(ImportError::NoHeadings(_))));
    let absent = TallyOptions { sheet: Some("DP"), ..TallyOptions::default() };
    let error = super::tally(&bytes, absent).unwrap_err();
    assert_eq!((error.option(), error.to_string().contains("Notes, BHA")), (Some("sheet"), true));
}

#[test]
fn units_that_are_missing_are_refused_or_assumed_by_name() {
    let text = "Item,Length,OD,ID\nBit,1,8,3\nCollar,30,8,3\n";
    let error = refused(text, TallyOptions::default());
    assert!(matches!(&error, ImportError::NoUnit { column, .. } if column == "B"), "{error}");
    assert_eq!(error.option(), Some("assumed_units"));
    let field = TallyOptions { assumed_units: Some(AssumedUnits::Field), ..TallyOptions::default() };
    let tally = with(text, field);
    assert_eq!((tally.sections[0].length, tally.sections[0].outer_diameter), (9.144, 0.2032));
    let units: Vec<_> =
        tally.columns.iter().map(|column| (column.unit.as_str(), column.is_assumed)).collect();
    assert_eq!(units, [("", false), ("ft", true), ("in", true), ("in", true)]);
    let wrong = refused("Item,Length (psi),OD (in),ID (in)\nBit,1,8,3\n", TallyOptions::default());
    assert!(matches!(wrong, ImportError::Unit { quantity: "length", .. }), "{wrong}");
}

#[test]
fn the_direction_is_that_of_the_bit_or_an_option() {
    let text = "Item,Length (m),OD (in),ID (in)\nJar,9,6.5,2.75\nDC,9,6.5,2.75\n";
    let error = refused(text, TallyOptions::default());
    assert_eq!(error.option(), Some("order"), "{error}");
    for (order, first) in [(TallyOrder::FromBit, "DC"), (TallyOrder::FromTop, "Jar")] {
        let tally = with(text, TallyOptions { order: Some(order), ..TallyOptions::default() });
        assert_eq!(tally.sections[0].name, first);
        assert_eq!(tally.remarks, ["the lowest component is no bit"]);
    }
}

#[test]
fn lengths_next_to_joints_are_settled_by_cumulative_lengths_or_an_option() {
    let header = "Item,Joints,Length (m),Cum. length (m),OD (in),ID (in)\nBit,1,0.30,0.30,8,3\n";
    for (row, length) in [("DC,3,9.20,27.90,8,3\n", 9.2), ("DC,3,27.60,27.90,8,3\n", 9.2)] {
        let tally = read(&format!("{header}{row}"));
        assert!((tally.sections[0].length - length).abs() < 1e-12, "{:?}", tally.sections[0]);
        assert_eq!((tally.sections[0].count, tally.remarks.len()), (3, 0));
    }
    let open = "Item,Joints,Length (m),OD (in),ID (in)\nBit,1,0.3,8,3\nDC,3,27.6,8,3\n";
    assert_eq!(refused(open, TallyOptions::default()).option(), Some("lengths"));
    for (lengths, length) in [(TallyLengths::Each, 27.6), (TallyLengths::Total, 9.2)] {
        let tally = with(open, TallyOptions { lengths: Some(lengths), ..TallyOptions::default() });
        assert!((tally.sections[0].length - length).abs() < 1e-12);
    }
}

#[test]
fn cumulative_lengths_that_disagree_are_remarked_on_in_both_directions() {
    let from_bit = "Item,Length (m),Cum (m),OD (in),ID (in)\nBit,0.3,0.3,8,3\nDC,9.2,9.5,8,3\nJar,9.6,19.6,8,3\nDC,9.2,28.8,8,3\n";
    let tally = read(from_bit);
    assert_eq!(tally.remarks, ["row 4: the length is 9.60 m, the cumulative length changes by 10.10 m"]);
    let from_top = "Item,Length (m),Cum (m),OD (in),ID (in)\nDC,9.2,28.8,8,3\nJar,9.6,19.6,8,3\nDC,9.2,9.5,8,3\nBit,0.3,0.3,8,3\n";
    let tally = read(from_top);
    assert_eq!(tally.remarks, ["row 3: the length is 9.60 m, the cumulative length changes by 10.10 m"]);
}

#[test]
fn equal_joints_that_follow_each_other_are_one_section() {
    let text = "Item,Length (m),OD (in),ID (in)\nBit,0.3,8,3\nDC,9.2,8,3\nDC,9.2,8,3\nDC,9.3,8,3\n";
    let tally = read(text);
    let counts: Vec<_> = tally.sections.iter().map(|section| (section.count, section.length)).collect();
    assert_eq!(counts, [(1, 9.3), (2, 9.2), (1, 0.3)]);
    assert_eq!(tally.components.len(), 4);
}

#[test]
fn cells_that_were_not_understood_have_row_and_column() {
    let text = "Item,Qty,Length (m),OD (in),ID (in),Weight (lb/ft),Grade\n\
        Bit,1,0.3,8,3,x,\nDC,two,9.2,8,3,150,\nDC,1,nine,8,3,150,\nDC,1,9.2,,3,150,\nDC,1,9.2,8,9,150,\n\
        DC,1,-9.2,8,3,150,\nDC,1,nan,8,3,150,\nDC,1.5,9.2,8,3,150,\nDC,1e9,9.2,8,3,150,\nDC,1,9.2,8,3,2,K-55\nTotal,,110,,,,\n,,,,,,\n";
    let tally = read(text);
    let problems: Vec<_> = tally
        .problems
        .iter()
        .map(|problem| (problem.row, problem.column.as_deref().unwrap_or_default(), problem.text.as_str()))
        .collect();
    let expected = [
        (2, "F", "x"),
        (3, "B", "two"),
        (4, "C", "nine"),
        (5, "D", ""),
        (6, "E", "9"),
        (7, "C", "-9.2"),
        (8, "C", "nan"),
        (9, "B", "1.5"),
        (10, "B", "1e9"),
        (12, "D", ""),
        (12, "E", ""),
    ];
    assert_eq!(problems, expected);
    assert_eq!(tally.sections.len(), 2);
    let remarks = &tally.components[0].remarks;
    assert!(remarks[0].contains("0.01 times that of steel"), "{remarks:?}");
    assert!(remarks[1].contains("K-55"), "{remarks:?}");
}

#[test]
fn several_tubulars_are_chosen_by_name() {
    let tubular = |name: &str, length: u32| {
        format!(
            "<tubular uid=\"{name}\"><name>{name}</name><tubularComponent><typeTubularComp>bit</typeTubularComp><od uom=\"in\">8</od>\
             <id uom=\"in\">3</id><len uom=\"m\">{length}</len></tubularComponent></tubular>"
        )
    };
    let xml = format!("<tubulars>\n{}\n{}\n</tubulars>", tubular("BHA 1", 1), tubular("BHA 2", 2));
    let error = refused(&xml, TallyOptions::default());
    assert_eq!((error.option(), error.to_string().contains("BHA 1, BHA 2")), (Some("sheet"), true));
    let chosen = TallyOptions { sheet: Some("BHA 2"), ..TallyOptions::default() };
    let tally = with(&xml, chosen);
    assert_eq!((tally.length, tally.components[0].row), (2.0, 3));
}

#[test]
fn hostile_tallies_end_in_an_error_or_bounded_problems() {
    let header = "Item,Length (m),OD (in),ID (in)\n";
    let nonsense = format!("{header}Bit,1,8,3\n{}", "x,y,z,w\n".repeat(20_000));
    assert!(read(&nonsense).problems.len() < MOST_PROBLEMS + 4);
    let many = |rows: usize| format!("{header}Bit,1,8,3\n{}", "DC,9,8,3\n".repeat(rows));
    assert_eq!(read(&many(MOST_COMPONENTS - 1)).sections[0].count as usize, MOST_COMPONENTS - 1);
    assert!(matches!(
        refused(&many(MOST_COMPONENTS), TallyOptions::default()),
        ImportError::TooMany { most: MOST_COMPONENTS, .. }
    ));
    assert!(matches!(refused(&many(1_000_000), TallyOptions::default()), ImportError::Grid(_)));
    let nested = format!("<tubulars>{}", "<tubular>".repeat(MOST_BYTES / 10));
    let inside = "<tubular><tubular><tubularComponent/></tubular><tubularComponent/></tubular>";
    let bomb = "<!DOCTYPE a [<!ENTITY b \"c\"><!ENTITY d \"&b;&b;\">]><tubular><tubularComponent><od>&d;</od></tubularComponent></tubular>";
    let attributes: String = (0..MOST_BYTES / 20).map(|at| format!(" a{at}=\"\"")).collect();
    let attributes = format!("<tubular{attributes}/>");
    let spaces: String = (0..20_000).map(|at| format!("<a xmlns:b{at}=\"c{at}\">")).collect();
    let latin = "<tubular>\u{e4}</tubular>".encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
    let one = "<tubular><tubularComponent/></tubular>";
    let files: [&[u8]; 14] = [
        b"",
        b"<",
        b"Item,Length (m),OD (in),ID (in)\n",
        b"Item,OD (in),ID (in)\nBit,8,3\n",
        b"Item,Length (m),OD (in),ID (in)\nBit,nan,inf,-3\n",
        b"Item,Length (m),OD (in),ID (in)\nBit,1e999,8,3\n",
        b"\xff\xfe\x00",
        nested.as_bytes(),
        inside.as_bytes(),
        bomb.as_bytes(),
        attributes.as_bytes(),
        spaces.as_bytes(),
        &latin,
        one.as_bytes(),
    ];
    for file in files {
        let start = String::from_utf8_lossy(&file[..file.len().min(60)]);
        assert!(tally(file, TallyOptions::default()).is_err(), "{start}");
    }
}
