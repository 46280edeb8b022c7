//! The page, from the sections.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::embed;
use crate::error::Result;
use crate::paper::folder::Folder;
use crate::paper::section::{Claim, Gallery, Plot, Section, Table, Verdict};
use crate::paper::{CITATION, REMARKS};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// The whole page.
///
/// # Errors
/// If a picture cannot be read.
pub fn page(folder: &Folder, sections: &[Section]) -> Result<String> {
    let parts: Vec<Markup> = sections.iter().map(|section| part(folder, section)).collect::<Result<_>>()?;
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Multiple Vertex Next Event Estimation, reproduced by fogbow" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Multiple Vertex Next Event Estimation, reproduced" }
                    p { (CITATION) ". Tables and figures by fogbow " (env!("CARGO_PKG_VERSION")) "." }
                    p { "Our cameras are right-handed, so that pictures are mirror images of those in the paper. "
                        "All pictures of a group have the same exposure." }
                    @for remark in REMARKS { p { (prose(remark)) } }
                    nav { @for section in sections { a href={ "#" (section.item) } { (section.title) } } }
                    (verdicts(sections))
                }
                main { @for part in parts { (part) } }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    Ok(markup.into_string())
}

/// All claims at a glance.
fn verdicts(sections: &[Section]) -> Markup {
    let all: Vec<_> =
        sections.iter().flat_map(|section| section.claims.iter().map(move |claim| (section, claim))).collect();
    html! {
        @if !all.is_empty() {
            h2 { "Published claims and what is found here" }
            table.verdicts {
                thead { tr { th { "" } th { "published" } th { "found" } } }
                tbody {
                    @for (section, claim) in all {
                        tr {
                            td { a href={ "#" (section.item) } { (section.item) } " " (mark(claim)) }
                            td { (prose(&claim.published)) }
                            td { (prose(&claim.found)) }
                        }
                    }
                }
            }
        }
    }
}

fn mark(claim: &Claim) -> Markup {
    let class = match claim.verdict {
        Verdict::Agrees => "agrees",
        Verdict::InPart => "in-part",
        Verdict::Differs => "differs",
        Verdict::Undecided => "undecided",
    };
    html! { span class=(class) { (claim.verdict.text()) } }
}

fn part(folder: &Folder, section: &Section) -> Result<Markup> {
    let galleries: Vec<Markup> =
        section.galleries.iter().map(|one| gallery(folder, one, unit(section, one))).collect::<Result<_>>()?;
    let plots: Vec<Markup> = section.plots.iter().map(|one| plot(folder, &section.item, one)).collect::<Result<_>>()?;
    Ok(html! {
        section id=(section.item) {
            h2 { (section.title) }
            @for paragraph in &section.text { p { (prose(paragraph)) } }
            @for claim in &section.claims { (said(claim)) }
            @for gallery in galleries { (gallery) }
            @for one in &section.tables { (table(one)) }
            div.plots { @for plot in plots { (plot) } }
            @if let Some(warning) = section.made.busy() { p.busy { "Warning: " (warning) "." } }
            p.made { (section.made.line()) }
        }
    })
}

/// Text with what stands between backticks as code.
fn prose(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn said(claim: &Claim) -> Markup {
    html! {
        div.claim {
            p { (mark(claim)) " Published: " (prose(&claim.published)) " " span.source { "(" (claim.source) ")" } }
            p { "Found: " (prose(&claim.found)) }
            @if !claim.why.is_empty() { p { "Why: " (prose(&claim.why)) } }
        }
    }
}

fn table(table: &Table) -> Markup {
    html! {
        figure {
            figcaption { (prose(&table.caption)) }
            table {
                thead { tr { @for title in table.titles() { th { (title) } } } }
                tbody { @for row in table.texts() { tr { @for cell in row { td { (cell) } } } } }
            }
        }
    }
}

fn plot(folder: &Folder, item: &str, plot: &Plot) -> Result<Markup> {
    let uri = embed::file(&folder.path(&format!("{item}/{}", plot.file)))?;
    Ok(html! {
        figure.plot.wide[plot.file.starts_with("paths")] {
            img src=(uri) alt=(plot.caption) loading="lazy";
            figcaption { (prose(&plot.caption)) }
        }
    })
}

/// What error maps of a gallery count in: the least error of all pictures of the item that have the same reference.
fn unit(section: &Section, gallery: &Gallery) -> Option<f64> {
    let judge = |one: &Gallery| one.pictures.last().filter(|_| one.has_reference).map(|last| last.file.clone());
    let reference = judge(gallery)?;
    let same = section.galleries.iter().filter(|one| judge(one).as_ref() == Some(&reference));
    let errors = same.flat_map(|one| &one.pictures[..one.pictures.len() - 1]).filter_map(|picture| picture.rmse);
    errors.filter(|error| *error > 0.0).min_by(f64::total_cmp)
}

/// The viewer of a gallery, whose error maps count in `unit`; the script fills it.
fn gallery(folder: &Folder, gallery: &Gallery, unit: Option<f64>) -> Result<Markup> {
    let pictures: Vec<_> = gallery
        .pictures
        .iter()
        .map(|picture| Ok((picture, embed::radiances(&folder.path(&picture.file))?)))
        .collect::<Result<_>>()?;
    let reference = if gallery.has_reference { "yes" } else { "no" };
    Ok(html! {
        figure.gallery data-exposure=(gallery.exposure) data-reference=(reference) data-unit=[unit] {
            figcaption { (prose(&gallery.caption)) }
            @for (picture, embedded) in &pictures {
                img.source hidden src=(embedded.uri) data-name=(picture.name) data-note=(picture.note) data-rmse=[picture.rmse]
                    data-width=(embedded.width) data-height=(embedded.height) alt=(picture.name);
            }
            noscript { p { "Pictures are shown by a script, which is part of this page." } }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::section::Picture;

    #[test]
    fn what_stands_between_backticks_is_code() {
        assert_eq!(prose("a < b, `fogbow paths` draws").into_string(), "a &lt; b, <code>fogbow paths</code> draws");
    }

    #[test]
    fn error_maps_of_a_reference_share_their_unit() {
        let picture = |file: &str, rmse| Picture { file: file.into(), name: String::new(), note: String::new(), rmse };
        let gallery = |errors: [f64; 2], reference: &str| {
            let judged = errors.map(|error| picture("a", Some(error)));
            let pictures = judged.into_iter().chain([picture(reference, Some(0.01))]).collect();
            Gallery { caption: String::new(), exposure: 0.0, pictures, has_reference: true }
        };
        let galleries = vec![gallery([0.5, 0.2], "r"), gallery([0.1, 0.0], "r"), gallery([3.0, 2.0], "other")];
        let section = Section { galleries, ..Section::default() };
        let units: Vec<_> = section.galleries.iter().map(|gallery| unit(&section, gallery)).collect();
        assert_eq!(units, [Some(0.1), Some(0.1), Some(2.0)]);
        let plain = Gallery { has_reference: false, ..section.galleries[0].clone() };
        assert_eq!(unit(&section, &plain), None);
    }
}
