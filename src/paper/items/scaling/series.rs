//! Series of settings that differ in one thing.

use toml::Value;

use super::ground;
use super::timing::Setting;
use crate::error::Result;
use crate::paper::bench::Bench;
use crate::scene::LoadedScene;

/// Series that the claim compares.
pub const LONG_MVNEE: &str = "MVNEE, any length";
pub const LONG_BRIDGES: &str = "bridges";

/// The group in which threads differ.
pub const THREADS: &str = "threads";

/// Series whose weights are timed.
const WEIGHED: [&str; 2] = [LONG_MVNEE, LONG_BRIDGES];

/// Settings that differ in one number.
pub struct Series {
    /// What it is called.
    pub name: String,
    /// What is varied: series of a group share a plot.
    pub group: &'static str,
    /// What the group's files are called.
    pub file: &'static str,
    /// The number.
    pub axis: &'static str,
    /// What the plot says.
    pub caption: &'static str,
    /// The settings.
    pub settings: Vec<Setting>,
}

/// A group of series.
#[derive(Clone, Copy)]
struct Group {
    group: &'static str,
    file: &'static str,
    axis: &'static str,
    caption: &'static str,
}

/// Techniques of most groups: what they are called in plots and in scenes.
const TECHNIQUES: [(&str, &str); 3] = [("NEE", "nee"), ("MVNEE-4", "mvnee"), ("bridges", "bridge")];

impl Group {
    fn series(&self, name: &str, settings: impl Iterator<Item = Result<Setting>>) -> Result<Series> {
        let Self { group, file, axis, caption } = *self;
        Ok(Series { name: name.into(), group, file, axis, caption, settings: settings.collect::<Result<_>>()? })
    }

    /// A series for each of the usual techniques, over `numbers`.
    fn by_technique<T: Copy>(
        &self,
        numbers: &[T],
        setting: impl Fn(T, (&'static str, Value)) -> Result<Setting>,
    ) -> Result<Vec<Series>> {
        let one = |(name, key): (&str, &'static str)| {
            self.series(name, numbers.iter().map(|number| setting(*number, technique(key))))
        };
        TECHNIQUES.into_iter().map(one).collect()
    }
}

/// Keys of a scene that are changed.
type Changes<'a> = &'a [(&'a str, Value)];

/// `scene` with every vertex connecting, `side` pixels wide and high.
fn load(bench: &Bench<'_>, scene: &str, side: u32, changes: Changes<'_>) -> Result<LoadedScene> {
    let side = i64::from(side);
    let own = [
        ("film.size", Value::from(vec![side, side])),
        ("render.starts", "all".into()),
        ("render.survival", 1.0.into()),
        ("render.roulette", 0.0.into()),
    ];
    bench.scenes.load(scene, &[&own, changes].concat())
}

fn technique(name: &'static str) -> (&'static str, Value) {
    ("render.technique", name.into())
}

/// Side of images where that is not varied.
const SIDE: u32 = 64;
/// Side of images of few pixels, so that in little time each has enough samples to fill batches of paths of any length.
const SMALL: u32 = 16;

/// All series, those of a group in a row.
pub fn all(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let groups = [
        segments(bench)?,
        connections(bench)?,
        threads(bench)?,
        lanes(bench)?,
        pixels(bench)?,
        triangles(bench)?,
        lights(bench)?,
    ];
    Ok(groups.into_iter().flatten().collect())
}

fn segments(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "longest path",
        file: "segments",
        axis: "longest path K [segments]",
        caption: "fog-facing, every vertex connects. Longer paths have more vertices that connect, each with longer \
                  chains and weights.",
    };
    let with = |name: &'static str, technique_name, more: Changes<'_>| {
        let setting = |k: i64| {
            let changes = [&[technique(technique_name), ("render.max_segments", Value::from(k))], more].concat();
            let setting = Setting::of(k as f64, load(bench, "fog-facing", SMALL, &changes)?, bench.threads());
            Ok(if WEIGHED.contains(&name) { setting.with_weights() } else { setting })
        };
        group.series(name, [5, 10, 20, 40, 80].into_iter().map(setting))
    };
    Ok(vec![
        with("path tracing", "path", &[])?,
        with("NEE", "nee", &[])?,
        with("MVNEE-4", "mvnee", &[])?,
        with(LONG_MVNEE, "mvnee", &[("render.mesc", 1e6.into())])?,
        with(LONG_BRIDGES, "bridge", &[])?,
    ])
}

fn connections(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "longest connection",
        file: "mesc",
        axis: "longest connection [expected segments]",
        caption: "dense-plate, K = 30. MESC limits how far MVNEE connects; bridges have a limit of the same kind.",
    };
    let with = |name, technique_name, key: &'static str| {
        let setting = |mesc: f64| {
            let changes = [technique(technique_name), (key, mesc.into())];
            Ok(Setting::of(mesc, load(bench, "dense-plate", SIDE, &changes)?, bench.threads()))
        };
        group.series(name, [1.0, 2.0, 4.0, 8.0, 16.0].into_iter().map(setting))
    };
    Ok(vec![with("MVNEE", "mvnee", "render.mesc")?, with("bridges", "bridge", "render.bridge_mesc")?])
}

fn threads(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: THREADS,
        file: "threads",
        axis: "threads",
        caption: "dense-plate. Processor time per sample: level where every thread does as much as one alone.",
    };
    let most = bench.threads().max(2);
    let counts: Vec<usize> = (0..).map(|power| 1 << power).take_while(|count| *count <= most).collect();
    group.by_technique(&counts, |count, technique| {
        Ok(Setting::of(count as f64, load(bench, "dense-plate", 2 * SIDE, &[technique])?, count))
    })
}

fn lanes(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "paths in flight",
        file: "wavefront",
        axis: "paths in flight per thread",
        caption: "dense-plate. With few paths lanes may be empty; many may not fit the caches.",
    };
    group.by_technique(&[64, 256, 1024, 4096, 16384], |lanes, technique| {
        let scene = load(bench, "dense-plate", SIDE, &[technique])?;
        Ok(Setting::of(lanes as f64, scene, bench.threads()).with_lanes(lanes))
    })
}

fn pixels(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "pixels",
        file: "resolution",
        axis: "width and height [pixels]",
        caption: "dense-plate. In small images few paths are in flight at a time.",
    };
    group.by_technique(&[16, 32, 64, 128, 256], |side, technique| {
        Ok(Setting::of(f64::from(side), load(bench, "dense-plate", side, &[technique])?, bench.threads()))
    })
}

fn triangles(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "triangles",
        file: "triangles",
        axis: "triangles",
        caption: "fog-facing above hilly ground of more and more triangles; K = 15 throughout.",
    };
    group.by_technique(&ground::SIDES, |side, technique| {
        let ground = ground::write(side)?;
        let geometry = ("geometry", Value::from(ground.path().to_string_lossy().into_owned()));
        let scene = load(bench, "fog-facing", SIDE, &[technique, geometry])?;
        Ok(Setting::of(f64::from(ground::triangles(side)), scene, bench.threads()))
    })
}

fn lights(bench: &Bench<'_>) -> Result<Vec<Series>> {
    let group = Group {
        group: "lights",
        file: "lights",
        axis: "lights",
        caption: "fog-facing with copies of its light side by side; more than 16 are chosen among by groups.",
    };
    group.by_technique(&[1, 4, 16, 64, 256, 1024], |count: i64, technique| {
        let scene = load(bench, "fog-facing", SIDE, &[technique, ("light", copies(count))])?;
        Ok(Setting::of(count as f64, scene, bench.threads()))
    })
}

/// Disks side by side that face the camera.
fn copies(count: i64) -> Value {
    let disk = |index: i64| {
        let x = index as f64 - 0.5 * (count - 1) as f64;
        let vector = |v: [f64; 3]| Value::from(v.to_vec());
        let keys = [
            ("type", Value::from("disk")),
            ("center", vector([x, 0.0, 5.0])),
            ("normal", vector([0.0, 0.0, -1.0])),
            ("radius", 0.4.into()),
            ("radiance", 80.0.into()),
        ];
        Value::Table(keys.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
    };
    Value::Array((0..count).map(disk).collect())
}
