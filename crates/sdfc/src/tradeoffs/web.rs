//! The plot as a page: beside each point the picture of its setting, and how far it is from the truth. The page is one file
//! that asks for nothing from elsewhere; without scripts its links and its table are left.

use super::page::{COLUMNS, proof};
use super::pictures::{address, difference, picture};
use super::plot::{Plot, plot};
use sdf_emit::html::{escaped, filled};
use sdfc::tradeoff::{Row, Tradeoffs};

const PAGE: &str = include_str!("web/page.html");
const STYLE: &str = include_str!("web/page.css");
const SCRIPT: &str = include_str!("web/page.js");

/// The page of a scene that was measured.
pub fn page(scene: &str, measured: &Tradeoffs) -> String {
    let scene_name = escaped(scene);
    let plot = marked(plot(scene, measured), measured);
    let truth = measured.truth.encoded();
    let true_picture = address(&picture(measured.size, &truth));
    let pictures = |(i, row): (usize, &Row)| setting(i, row, measured, &truth);
    let settings: String = measured.rows.iter().enumerate().map(pictures).collect();
    let columns: String = COLUMNS.iter().map(|(name, _)| format!("<th scope=\"col\">{name}</th>")).collect();
    let rows: String = measured.rows.iter().enumerate().map(|(i, row)| line(i, row)).collect();
    let orange = if measured.truth.undecided() > 0 { " In the differences they are orange." } else { "" };
    let undecided = format!("Of this scene {}.{orange}", proof(&measured.truth));
    filled(PAGE, |name| match name {
        "scene" => &scene_name,
        "style" => STYLE,
        "plot" => &plot,
        "truth" => &true_picture,
        "undecided" => &undecided,
        "settings" => &settings,
        "columns" => &columns,
        "rows" => &rows,
        "script" => SCRIPT,
        other => unreachable!("the page has no part {other}"),
    })
}

/// The plot with a link upon each point.
fn marked(plot: Plot, measured: &Tradeoffs) -> String {
    let mark = |(i, row): (usize, &Row)| {
        let (x, y) = plot.places[i]?;
        let text = escaped(&format!("{}: {}", row.setting.name, figures(row)));
        Some(format!(
            "<a class=\"mark\" href=\"#s{i}\" data-row=\"{i}\" aria-label=\"{text}\"><title>{text}</title>\
             <circle cx=\"{x}\" cy=\"{y}\" r=\"10\"/></a>\n"
        ))
    };
    let marks: String = measured.rows.iter().enumerate().filter_map(mark).collect();
    let (drawn, end) = plot.svg.rsplit_once("</svg>").expect("a plot ends");
    format!("{drawn}{marks}</svg>{end}")
}

/// The figures of a setting, in words.
fn figures(row: &Row) -> String {
    COLUMNS.map(|(name, show)| format!("{name} {}", show(row))).join(", ")
}

/// The pictures of a setting.
fn setting(i: usize, row: &Row, measured: &Tradeoffs, truth: &[[f32; 3]]) -> String {
    let name = escaped(&row.setting.name);
    let figures = escaped(&figures(row));
    let own = address(&picture(measured.size, &row.colors));
    let difference = difference(measured.size, &row.colors, truth, &measured.truth.colored);
    let apart = address(&difference.picture);
    let factor = match difference.factor {
        Some(factor) => format!("difference, times {factor}"),
        None => "difference: none".into(),
    };
    let rays = match row.setting.accuracy.antialias {
        1 => String::new(),
        n => format!("; {} rays a pixel beside one", n * n),
    };
    format!(
        "<section class=\"setting\" id=\"s{i}\" aria-label=\"{name}\">\n\
         <figure><img loading=\"lazy\" alt=\"The picture of {name}\" src=\"{own}\"><figcaption>{name}</figcaption></figure>\n\
         <figure><img loading=\"lazy\" alt=\"How far that is from the truth\" src=\"{apart}\">\
         <figcaption>{factor}{rays}</figcaption></figure>\n\
         <p>{figures}</p>\n</section>\n"
    )
}

/// A setting in the table.
fn line(i: usize, row: &Row) -> String {
    let name = escaped(&row.setting.name);
    let class = if row.on_frontier { " class=\"frontier\"" } else { "" };
    let cells: String = COLUMNS.iter().map(|(_, show)| format!("<td>{}</td>", escaped(&show(row)))).collect();
    format!(
        "<tr data-row=\"{i}\"{class}><th scope=\"row\"><a href=\"#s{i}\" data-row=\"{i}\">{name}</a></th>{cells}</tr>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::page;
    use crate::tradeoffs::sample::{measured, presets, untimed};

    #[test]
    fn it_asks_for_nothing_from_elsewhere() {
        let page = page("a.sdf", &presets());
        assert_eq!(page.matches("http").count(), 1);
        assert!(page.contains("xmlns=\"http://www.w3.org/2000/svg\""));
        for address in page.split("src=\"").skip(1) {
            assert!(address.starts_with("data:image/png;base64,"), "{}", &address[..40]);
        }
        for link in page.split("href=\"").skip(1) {
            assert!(link.starts_with('#') || link.starts_with("data:,"), "{}", &link[..20]);
        }
    }

    #[test]
    fn each_setting_has_its_mark_its_line_and_its_pictures() {
        let measured = presets();
        let page = page("a.sdf", &measured);
        for i in 0..measured.rows.len() {
            assert_eq!(page.matches(&format!("class=\"mark\" href=\"#s{i}\"")).count(), 1, "{i}");
            assert_eq!(page.matches(&format!("<th scope=\"row\"><a href=\"#s{i}\"")).count(), 1, "{i}");
            assert_eq!(page.matches(&format!("id=\"s{i}\"")).count(), 1, "{i}");
        }
        assert_eq!(page.matches("<img ").count(), 1 + 2 * measured.rows.len());
        // Of the two that are equal the first is on it.
        assert_eq!(page.matches("class=\"frontier\"").count(), 4);
    }

    #[test]
    fn names_are_no_markup() {
        let mut measured = measured(&[(2.0, 1.0)]);
        measured.rows[0].setting.name = "<i>'own\"".into();
        let page = page("</title><script>alert(1)</script>.sdf", &measured);
        assert!(!page.contains("<script>alert") && !page.contains("<i>"));
        assert!(page.contains("<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;.sdf"));
        assert!(page.contains("aria-label=\"&lt;i&gt;&#39;own&quot;: ms 2.00,"));
    }

    #[test]
    fn without_times_there_are_no_marks() {
        let page = page("a.sdf", &untimed());
        assert!(!page.contains("class=\"mark\"") && page.contains("id=\"s0\""));
    }
}
