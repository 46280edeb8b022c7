//! Settings of bridges: what is refused, where, and with which remedy.

use super::support::Folder;

/// The scene with this line in its render table is refused there, with `finding` and `remedy`.
#[track_caller]
fn refused_setting(line: &str, finding: &str, remedy: &str) {
    let folder = Folder::with_edited_scene("mesc = 4", &format!("mesc = 4\n{line}"));
    let beginning = format!("{}: {finding}", folder.place(line));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    assert!(run.stderr.contains(&format!("  help: {remedy}")), "{run}");
}

#[test]
fn settings_of_bridges_are_of_the_right_type() {
    let listed = "see fogbow render --help-scene for every key";
    let starts = "a whole number from 1 to 1024, \"all\" or \"auto\"\n";
    for (written, shown) in [
        ("1.5", "number `1.5`"),
        ("\"some\"", "string \"some\""),
        ("\"7\"", "string \"7\""),
        ("true", "boolean `true`"),
    ] {
        let finding = format!("render.starts: this is the {shown}, expected {starts}");
        refused_setting(&format!("starts = {written}"), &finding, listed);
    }
    for number in ["-1", "4294967296"] {
        let finding = format!("render.starts: {number} is out of range\n");
        refused_setting(&format!("starts = {number}"), &finding, &format!("give {starts}"));
    }
    for key in ["survival", "aimed"] {
        for (written, shown) in
            [("\"maybe\"", "the string \"maybe\""), ("true", "the boolean `true`"), ("[1]", "a list")]
        {
            let finding = format!("render.{key}: this is {shown}, expected a number or \"auto\"\n");
            refused_setting(&format!("{key} = {written}"), &finding, listed);
        }
    }
    let whole = "a whole number from 0 to 4294967295\n";
    for (written, shown) in [("1.5", "number `1.5`"), ("\"all\"", "string \"all\"")] {
        let finding = format!("render.bridge_vertices: this is the {shown}, expected {whole}");
        refused_setting(&format!("bridge_vertices = {written}"), &finding, listed);
    }
    let finding = "render.bridge_vertices: -1 is out of range\n";
    refused_setting("bridge_vertices = -1", finding, &format!("give {whole}"));
    let finding = "render.bridge_mesc: this is the string \"auto\", expected a number\n";
    refused_setting("bridge_mesc = \"auto\"", finding, listed);
    refused_setting("roll = \"x\"", "render.roll: unknown name `x`, expected `aligned` or `uniform`\n", listed);
    refused_setting("lis = \"x\"", "render.lis: unknown name `x`, expected `bridge` or `mvnee`\n", listed);
}

#[test]
fn settings_of_bridges_are_in_range() {
    let remedy = "give a number from 1 to 1024, \"all\" or \"auto\"";
    for count in ["0", "1025", "4294967295"] {
        refused_setting(&format!("starts = {count}"), &format!("render.starts is {count}\n"), remedy);
    }
    refused_setting("aimed = 1", "render.aimed is 1.0\n", "give a fraction from 0 to 0.99, or \"auto\"");
    for (written, shown) in
        [("0", "0.0"), ("1.5", "1.5"), ("-1", "-1.0"), ("nan", "NaN"), ("inf", "inf"), ("0.001", "0.001")]
    {
        let remedy = "give a probability from 0.01 to 1, or \"auto\"";
        refused_setting(&format!("survival = {written}"), &format!("render.survival is {shown}\n"), remedy);
    }
    for (written, shown) in [("-1", "-1.0"), ("nan", "NaN"), ("inf", "inf"), ("1e31", "1e31")] {
        let remedy = "give a radiance from 0 to 1e30 W/(m^2 sr), or \"auto\"";
        refused_setting(&format!("roulette = {written}"), &format!("render.roulette is {shown}\n"), remedy);
    }
    for (written, shown) in [("0", "0.0"), ("-3", "-3.0"), ("nan", "NaN"), ("inf", "inf")] {
        let remedy = "give a number of segments above 0, or leave it out for no limit";
        refused_setting(&format!("bridge_mesc = {written}"), &format!("render.bridge_mesc is {shown}\n"), remedy);
    }
}

#[test]
fn settings_of_bridges_may_stand_in_the_scene_or_behind_set() {
    for setting in [
        "starts = \"all\"",
        "starts = \"auto\"",
        "starts = 3",
        "starts = 1024",
        "survival = 1",
        "survival = 0.01",
        "survival = \"auto\"",
        "roulette = 0",
        "roulette = 0.5",
        "roulette = \"auto\"",
        "roll = \"uniform\"",
        "bridge_mesc = 2.5",
        "lis = \"mvnee\"",
        "bridge_vertices = 0",
        "bridge_vertices = 4294967295",
    ] {
        let flags = ["--technique", "bridge", "--progress", "none"];
        let written = Folder::with_edited_scene("mesc = 4", &format!("mesc = 4\n{setting}"));
        written.done(&[&["render", "scene.toml", "-o", "a.exr"], &flags[..]].concat());
        let plain = Folder::with_scene();
        let set = format!("render.{setting}");
        plain.done(&[&["render", "scene.toml", "-o", "a.exr", "--set", &set], &flags[..]].concat());
        assert!(written.image("a.exr").channels == plain.image("a.exr").channels, "{setting}");
    }
}
