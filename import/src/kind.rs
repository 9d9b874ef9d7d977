//! Kinds of components by the words of their descriptions.

use drillsweep_scenario::SectionKind;

/// Words of descriptions with the kinds that they mean; the first ones that a description has decide. Tools whose names have the word of another
/// part, such as a bit sub or a motor with stabilizers, stand before that part.
const WORDS: [(&str, SectionKind); 51] = [
    ("bit sub", SectionKind::Collar),
    ("sub bit", SectionKind::Collar),
    ("near bit", SectionKind::Stabilizer),
    ("motor", SectionKind::Collar),
    ("pdm", SectionKind::Collar),
    ("turbine", SectionKind::Collar),
    ("rss", SectionKind::Collar),
    ("rotary steerable", SectionKind::Collar),
    ("mwd", SectionKind::Collar),
    ("lwd", SectionKind::Collar),
    ("stabilizer", SectionKind::Stabilizer),
    ("stabiliser", SectionKind::Stabilizer),
    ("stab", SectionKind::Stabilizer),
    ("nb stab", SectionKind::Stabilizer),
    ("nbs", SectionKind::Stabilizer),
    ("roller reamer", SectionKind::Stabilizer),
    ("reamer", SectionKind::Collar),
    ("underreamer", SectionKind::Collar),
    ("hole opener", SectionKind::Collar),
    ("hwdp", SectionKind::Drillpipe),
    ("hwp", SectionKind::Drillpipe),
    ("heavy weight", SectionKind::Drillpipe),
    ("heavyweight", SectionKind::Drillpipe),
    ("drill collar", SectionKind::Collar),
    ("drillcollar", SectionKind::Collar),
    ("collar", SectionKind::Collar),
    ("dc", SectionKind::Collar),
    ("nmdc", SectionKind::Collar),
    ("pony", SectionKind::Collar),
    ("monel", SectionKind::Collar),
    ("jar", SectionKind::Collar),
    ("accelerator", SectionKind::Collar),
    ("shock", SectionKind::Collar),
    ("sub", SectionKind::Collar),
    ("xo", SectionKind::Collar),
    ("x over", SectionKind::Collar),
    ("crossover", SectionKind::Collar),
    ("cross over", SectionKind::Collar),
    ("flex", SectionKind::Collar),
    ("bit", SectionKind::Bit),
    ("pdc", SectionKind::Bit),
    ("tricone", SectionKind::Bit),
    ("roller cone", SectionKind::Bit),
    ("core head", SectionKind::Bit),
    ("corehead", SectionKind::Bit),
    ("drill pipe", SectionKind::Drillpipe),
    ("drillpipe", SectionKind::Drillpipe),
    ("dp", SectionKind::Drillpipe),
    ("pipe", SectionKind::Drillpipe),
    ("hevi wate", SectionKind::Drillpipe),
    ("heviwate", SectionKind::Drillpipe),
];

/// Kind of a component by its description, with the words that decide; `None` if it has none of them.
pub(crate) fn kind(description: &str) -> Option<(SectionKind, &'static str)> {
    let lower = description.to_lowercase();
    let words = lower.split(|sign: char| !sign.is_alphanumeric()).filter(|word| !word.is_empty());
    let words: Vec<&str> = words.collect();
    let is_word = |word: &str, wanted: &str| word == wanted || word.strip_suffix('s') == Some(wanted);
    let has = |phrase: &str| {
        let phrase: Vec<&str> = phrase.split(' ').collect();
        words
            .windows(phrase.len())
            .any(|part| part.iter().zip(&phrase).all(|(word, wanted)| is_word(word, wanted)))
    };
    WORDS.into_iter().find(|(phrase, _)| has(phrase)).map(|(phrase, kind)| (kind, phrase))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_of_tallies_and_types_of_witsml_have_kinds() {
        use SectionKind::{Bit, Collar, Drillpipe, Stabilizer};
        for (description, expected) in [
            ("12 1/4\" PDC Bit", Some(Bit)),
            ("bit roller cone", Some(Bit)),
            ("Bit sub w/ float", Some(Collar)),
            ("sub-bit", Some(Collar)),
            ("Near-bit stabilizer", Some(Stabilizer)),
            ("12 1/8 in-line stabilizer", Some(Stabilizer)),
            ("Motor, 12 1/8 stabilizers", Some(Collar)),
            ("motor steerable", Some(Collar)),
            ("Telescope 950 (MWD)", Some(Collar)),
            ("ARC-9 (LWD)", Some(Collar)),
            ("9.5\" NM pony", Some(Collar)),
            ("3 x 8\" Drill Collars", Some(Collar)),
            ("8\" DC", Some(Collar)),
            ("X-over", Some(Collar)),
            ("Hydraulic jar", Some(Collar)),
            ("15 Jts 5\" HWDP", Some(Drillpipe)),
            ("heavy weight drillpipe", Some(Drillpipe)),
            ("5\" 19.5# S-135 DP", Some(Drillpipe)),
            ("Drill Pipe 5 7/8", Some(Drillpipe)),
            ("Total", None),
            ("", None),
        ] {
            assert_eq!(kind(description).map(|(kind, _)| kind), expected, "{description}");
        }
    }
}
