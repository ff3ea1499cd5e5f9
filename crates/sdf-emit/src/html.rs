//! Texts in pages: made harmless, and filled into a form.

/// A text as it can be shown: what cannot be seen, or turns the text round, becomes a space.
pub fn visible(text: &str) -> String {
    let is_hidden = |c: char| {
        c.is_control()
            || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
            // No XML may hold these.
            || matches!(c, '\u{fffe}' | '\u{ffff}')
    };
    text.chars().map(|c| if is_hidden(c) { ' ' } else { c }).collect()
}

/// A text in HTML, as an attribute or between elements. What cannot be seen becomes a space.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in visible(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// A form with its parts in the places of their marks, `<!--{name}-->`.
pub fn filled<'a>(form: &str, part: impl Fn(&str) -> &'a str) -> String {
    let mut pieces = form.split("<!--{");
    let mut out = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}-->").expect("the marks of a form are closed");
        out.push_str(part(name));
        out.push_str(rest);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{escaped, filled};

    #[test]
    fn no_text_leaves_its_place() {
        assert_eq!(escaped("</title><script>\"'&\n"), "&lt;/title&gt;&lt;script&gt;&quot;&#39;&amp; ");
        assert_eq!(escaped("Größe\u{202e}\u{ffff}"), "Größe  ");
    }

    #[test]
    fn parts_stand_in_their_places() {
        let part = |name: &str| if name == "a" { "<!--{b}-->" } else { "" };
        assert_eq!(filled("1<!--{a}-->2<!--{c}-->3", part), "1<!--{b}-->23");
    }
}
