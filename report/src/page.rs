//! The document around a report.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// Content security policy of a report: its own style by its hash, and nothing else.
pub const POLICY: &str =
    "default-src 'none'; style-src 'sha256-QBQCqeFPt9Cc3Bf31HJhEN7WIznifK6Ia6eZK3Nc9u4='";

/// A self-contained HTML document without scripts; a saved file keeps to [`POLICY`], too.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="referrer" content="no-referrer";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    }
    .into_string()
}

#[cfg(test)]
mod tests {
    use sha2::{Digest, Sha256};

    use super::*;

    /// Base 64 (RFC 4648, section 4).
    fn base64(bytes: &[u8]) -> String {
        const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let group = |group: &[u8]| {
            let bits =
                (0..3).fold(0u32, |bits, place| (bits << 8) | u32::from(*group.get(place).unwrap_or(&0)));
            let sign = |place: usize| match place <= group.len() {
                true => char::from(SIGNS[(bits >> (18 - 6 * place)) as usize & 63]),
                false => '=',
            };
            [0, 1, 2, 3].map(sign)
        };
        bytes.chunks(3).flat_map(group).collect()
    }

    #[test]
    fn the_policy_names_the_style() {
        assert_eq!(base64(b"foobar") + &base64(b"fooba") + &base64(b"foob"), "Zm9vYmFyZm9vYmE=Zm9vYg==");
        let hash = base64(&Sha256::digest(STYLE));
        assert_eq!(POLICY, format!("default-src 'none'; style-src 'sha256-{hash}'"));
    }
}
