//! The findings as one page that needs nothing else.

use super::svg::{escaped, svg};
use super::text::{HEADINGS, cells};
use super::{CaseReport, Pictures, counts};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use std::fmt::Write as _;

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1d2126; --paper: #fff; --line: #d8dde3; --dim: #5f6a76; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e8ec; --paper: #16191d; --line: #343b43; --dim: #97a3af; } }
body { margin: 2rem auto; max-width: 72rem; padding: 0 1rem; font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid var(--line); vertical-align: top; }
td small { color: var(--dim); display: block; }
.short { color: #d1242f; font-weight: 600; }
.pass { color: #1a7f37; }
figure { margin: 1.2rem 0; max-width: 46rem; }
figcaption { font-weight: 600; }
svg, img { width: 100%; height: auto; }
svg text { font-size: 12px; fill: var(--dim); }
svg .grid { stroke: var(--line); fill: none; }
.legend span { margin-right: 1rem; white-space: nowrap; }
.legend i { display: inline-block; width: .8rem; height: .8rem; margin-right: .3rem; border-radius: 2px; }
";

/// The page, with its plots and pictures inside.
#[must_use]
pub fn html(reports: &[CaseReport], is_quick: bool, pictures: &Pictures) -> String {
    let [pass, short, shown] = counts(reports);
    let quick = if is_quick { " --quick" } else { "" };
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>Verification of hammerfall</title>\n<style>{STYLE}</style>\n<h1>Verification</h1>\n\
         <p><code>hammerfall verify{quick}</code>, version {}: {pass} quantities pass, {short} fall short, {shown} are only shown. \
         Below each quantity stands where its reference comes from, and why its bound is what it is.</p>\n",
        env!("CARGO_PKG_VERSION")
    );
    if let Some(missing) = &pictures.missing {
        let _ = writeln!(page, "<p>{}</p>", escaped(missing));
    }
    contents(&mut page, reports);
    for report in reports {
        section(&mut page, report);
        pictures_of(&mut page, report, pictures);
    }
    page.push_str("</html>\n");
    page
}

fn contents(page: &mut String, reports: &[CaseReport]) {
    page.push_str("<ul>\n");
    for report in reports {
        let (id, title) = (report.case.id, escaped(report.case.title));
        let (class, word) = if report.passes() { ("pass", "pass") } else { ("short", "falls short") };
        let _ = writeln!(
            page,
            "<li><a href=\"#{id}\">{id}</a>: {title}, <span class=\"{class}\">{word}</span></li>"
        );
    }
    page.push_str("</ul>\n");
}

fn section(page: &mut String, report: &CaseReport) {
    let (id, title) = (report.case.id, escaped(report.case.title));
    let _ = writeln!(page, "<h2 id=\"{id}\">{id}: {title}</h2>");
    let outcome = match &report.outcome {
        Ok(outcome) => outcome,
        Err(reason) => {
            let _ = writeln!(page, "<p class=\"short\">It could not be measured: {}</p>", escaped(reason));
            return;
        }
    };
    let headings = HEADINGS.map(|heading| format!("<th>{heading}</th>")).concat();
    let _ = writeln!(page, "<table>\n<tr>{headings}</tr>");
    for quantity in &outcome.quantities {
        let [name, value, reference, error, bound, verdict] = cells(quantity).map(|cell| escaped(&cell));
        let class = match quantity.verdict() {
            "falls short" => "short",
            verdict => verdict,
        };
        let [source, reason] = [quantity.source, quantity.reason].map(escaped);
        let _ = writeln!(
            page,
            "<tr><td>{name}<small>{source}</small></td><td>{value}</td><td>{reference}</td><td>{error}</td>\
             <td>{bound}<small>{reason}</small></td><td class=\"{class}\">{verdict}</td></tr>"
        );
    }
    page.push_str("</table>\n");
    for plot in &outcome.plots {
        let (caption, id) = (escaped(plot.title), plot.id);
        let _ = writeln!(
            page,
            "<figure>\n<figcaption>{caption}</figcaption>\n{}<small>{id}.csv</small>\n</figure>",
            svg(plot)
        );
    }
}

fn pictures_of(page: &mut String, report: &CaseReport, pictures: &Pictures) {
    for picture in pictures.list.iter().filter(|picture| picture.case == report.case.id) {
        let caption = escaped(picture.caption);
        let data = BASE64.encode(&picture.png);
        let _ = writeln!(
            page,
            "<figure>\n<figcaption>{caption}</figcaption>\n<img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\n</figure>"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::Picture;
    use super::*;
    use crate::verify::{Outcome, find};

    #[test]
    fn pictures_stand_in_the_page_itself_or_the_page_says_why_there_are_none() {
        let reports =
            [CaseReport { case: find("rods").expect("it is in the list"), outcome: Ok(Outcome::default()) }];
        let picture = |case| Picture { case, caption: "a < b", png: b"\x89PNG\r\n".to_vec() };
        let pictures = Pictures { list: vec![picture("rods"), picture("spin")], missing: None };
        let page = html(&reports, true, &pictures);
        assert_eq!(page.matches("<img").count(), 1);
        assert!(page.contains("data:image/png;base64,iVBORw0K\"") && page.contains("alt=\"a &lt; b\""));
        let without =
            Pictures { list: Vec::new(), missing: Some("The page has no pictures: no GPU".to_owned()) };
        let page = html(&reports, true, &without);
        assert!(page.contains("no pictures: no GPU") && !page.contains("<img"));
    }
}
