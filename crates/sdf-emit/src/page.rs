//! A shader as a page that runs by itself: one file of HTML that holds the text for WebGL2, and a script round it.

use crate::html::{escaped, filled};
use crate::symbols::Symbols;
use crate::{EmitError, Header, Target, ValidationError, emit};
use sdf_ir::{Constant, Program, Role, Uniform};
use std::f64::consts::PI;
use std::fmt::Write;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = include_str!("page/page.js");

/// The page.
pub(crate) fn page(program: &Program, header: &Header) -> Result<String, EmitError> {
    let fragment = emit(program, Target::GlslEs, header)?;
    if fragment.contains("</") || fragment.contains("<!") {
        let message = "the text would end the element of the page that holds it".to_owned();
        return Err(EmitError::Invalid(ValidationError { message }));
    }
    let title = escaped(&header.title);
    let params = params(program);
    let part = |name: &str| match name {
        "title" => title.as_str(),
        "style" => STYLE,
        "params" => params.as_str(),
        "fragment" => fragment.as_str(),
        "script" => SCRIPT,
        other => unreachable!("the page has no part {other}"),
    };
    Ok(filled(PAGE, part))
}

/// What the page's sliders change, and how far the camera can be tilted, as JSON.
fn params(program: &Program) -> String {
    let symbols = Symbols::of(program, Target::GlslEs);
    let list = program.uniforms.iter().zip(&symbols.uniforms);
    let list: Vec<String> = list.filter_map(|(uniform, name)| param(uniform, &name.text)).collect();
    let tilt = program.uniforms.iter().find_map(|u| match u.role {
        Role::Orbit { tilt } => Some(tilt),
        _ => None,
    });
    let (low, high) = tilt.unwrap_or((-PI, PI));
    format!("{{\n\"tilt\": [{low}, {high}],\n\"list\": [\n{}\n]\n}}", list.join(",\n"))
}

/// A param as an object. A float without a range has no slider.
fn param(uniform: &Uniform, name: &str) -> Option<String> {
    let Role::Param { range, .. } = uniform.role else { return None };
    let (kind, value) = match (uniform.default, range) {
        (Constant::Bool(on), _) => ("\"bool\"".to_owned(), on.to_string()),
        (Constant::Float(x), Some((low, high))) => {
            (format!("\"float\", \"low\": {low}, \"high\": {high}"), x.to_string())
        }
        (Constant::Vec3([r, g, b]), _) => ("\"color\"".to_owned(), format!("[{r}, {g}, {b}]")),
        _ => return None,
    };
    let source = quoted(&uniform.name);
    let name = quoted(name);
    Some(format!("{{\"name\": {source}, \"uniform\": {name}, \"kind\": {kind}, \"value\": {value}}}"))
}

/// A text in JSON that may stand in a script: letters, digits and underscores as they are, all else by number.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for unit in text.encode_utf16() {
        match u8::try_from(unit) {
            Ok(c) if c.is_ascii_alphanumeric() || c == b'_' => out.push(char::from(c)),
            _ => write!(out, "\\u{unit:04x}").expect("writing to a string cannot fail"),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn no_text_leaves_its_place() {
        assert_eq!(quoted("spin_2"), "\"spin_2\"");
        assert_eq!(quoted("</script>\u{2028}ü\"\\"), r#""\u003c\u002fscript\u003e\u2028\u00fc\u0022\u005c""#);
    }
}
