//! `fogbow presets`

use serde::Serialize;

use super::{PresetsArgs, say};
use crate::error::Result;
use crate::figures::number;
use crate::scene::presets::{PRESETS, Preset};
use crate::scene::schema::Phase;

/// Characters of a line.
const WIDTH: usize = 80;
/// Characters of a name and the space behind it.
const NAME: usize = 12;

/// A preset with what follows from its numbers.
#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    preset: &'a Preset,
    /// In metres.
    mean_free_path: [f64; 3],
}

pub fn run(args: &PresetsArgs) -> Result<()> {
    if args.json {
        let entries = PRESETS.each_ref().map(|preset| Entry { preset, mean_free_path: preset.mean_free_path() });
        return say(serde_json::json!({ "presets": entries }));
    }
    let channels = columns(["red", "green", "blue"].map(String::from));
    say(format!("{:NAME$}{:>20}  {:>20}  {:>20}", "", "scattering [1/m]", "absorption [1/m]", "mean free path"))?;
    say(format!("{:NAME$}{channels}  {channels}  {channels}", "name"))?;
    PRESETS.iter().try_for_each(|preset| say(row(preset)))?;
    PRESETS.iter().try_for_each(describe)
}

/// The numbers of `preset`.
fn row(preset: &Preset) -> String {
    let [scattering, absorption] = [preset.scattering, preset.absorption].map(|channels| columns(channels.map(exact)));
    let path = preset.mean_free_path();
    let (unit, scale) = if path.iter().any(|length| *length >= 1.0) { ("m", 1.0) } else { ("mm", 1e3) };
    let path = columns(path.map(|length| number(length * scale, 3)));
    format!("{:NAME$}{scattering}  {absorption}  {path} {unit}", preset.name)
}

/// A number as it is.
fn exact(value: f64) -> String {
    value.to_string()
}

fn columns(channels: [String; 3]) -> String {
    channels.map(|channel| format!("{channel:>6}")).join(" ")
}

/// What the numbers of `preset` mean and where they come from.
fn describe(preset: &Preset) -> Result<()> {
    say(format!("\n{}: {}", preset.name, preset.meaning))?;
    say(paragraph("phase", &inline(&preset.phase)))?;
    say(paragraph("source", preset.source))?;
    say(paragraph("conversion", preset.conversion))
}

/// A phase function as a scene file says it: names and numbers of JSON are those of TOML.
fn inline(phase: &Phase) -> String {
    let keys = serde_json::to_value(phase).expect("a phase function is made of numbers and names");
    let keys = keys.as_object().into_iter().flatten().map(|(key, value)| format!("{key} = {value}"));
    format!("{{ {} }}", keys.collect::<Vec<_>>().join(", "))
}

/// `text` in lines that stand behind its `title`.
fn paragraph(title: &str, text: &str) -> String {
    let mut lines = vec![format!("  {title:NAME$}")];
    let indent = lines[0].len();
    for word in text.split(' ') {
        let line = lines.last_mut().expect("a line");
        if line.len() > indent && line.len() + 1 + word.len() > WIDTH {
            lines.push(format!("{:indent$}{word}", ""));
        } else {
            line.push_str(if line.len() > indent { " " } else { "" });
            line.push_str(word);
        }
    }
    lines.join("\n")
}
