//! `motif align`.

mod outputs;

use std::io::{self, Write};

use dtw::DtwError;
use mocap_io::FrameRate;
use relfeat::FeatureSet;
use serde::Serialize;

use self::outputs::Outputs;
use super::index::DEFAULT_SET;
use super::{tell_filled, tell_warnings};
use crate::align::pair::{Pair, Posed};
use crate::align::{Alignment, Cells, DEFAULT_MARGIN_SECONDS, Resolution, align, full_cost};
use crate::args::{AlignArgs, Global};
use crate::failure::{Exit, Failure};
use crate::library::NamedSet;
use crate::output::{Outcome, count};
use crate::source::ClipRef;
use crate::take::Take;

/// An alignment, or why there is none.
#[derive(Clone, Debug, Serialize)]
pub struct AlignResult {
    /// The first clip.
    pub a: SideJson,
    /// The second one.
    pub b: SideJson,
    /// Poses per second that were compared.
    pub rate: f64,
    /// The body points that were compared.
    pub points: Vec<&'static str>,
    /// The path and what it costs; none if the clips cannot be aligned.
    pub alignment: Option<AlignmentJson>,
    /// Why there is no alignment.
    pub reason: Option<String>,
    /// What was written.
    pub files: Vec<String>,
}

/// One of the two clips.
#[derive(Clone, Debug, Serialize)]
pub struct SideJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// First source frame.
    pub start: usize,
    /// One past the last source frame.
    pub end: usize,
    /// Frames per second of the file.
    pub rate: f64,
    /// Poses that were compared.
    pub poses: usize,
    /// Frames that have no pose, because the root or half of the body is missing.
    pub left_out: usize,
}

/// The path and what it costs.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentJson {
    /// The sum of the steps' costs, in metres.
    pub cost: f64,
    /// The mean of the steps' costs, in metres.
    pub mean_distance: f64,
    /// Cells that were computed.
    pub cells: CellsJson,
    /// The cost of DTW over the full matrix, if it was computed.
    pub full_cost: Option<f64>,
    /// By how much `cost` is above `full_cost`, as a share of it.
    pub excess: Option<f64>,
    /// The mean distance of each point along the path, in metres.
    pub point_distances: Vec<Option<f64>>,
    /// From both first frames to both last ones.
    pub path: Vec<StepJson>,
}

/// How much of the matrix was computed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CellsJson {
    /// To align segments.
    pub segments: u64,
    /// In bands, at all rates together.
    pub bands: u64,
    /// Of the full matrix.
    pub full: u64,
    /// `(segments + bands) / full`.
    pub share: f64,
}

/// A step of the path: a frame of the one clip and its frame of the other.
#[derive(Clone, Debug, Serialize)]
pub struct StepJson {
    /// Source frame of the first clip.
    pub a: usize,
    /// Source frame of the second clip.
    pub b: usize,
    /// Its time in the source file, in seconds.
    pub a_s: f64,
    /// Likewise.
    pub b_s: f64,
    /// The mean of `points`, in metres.
    pub cost: f64,
    /// The distance of each point, in metres; none where one of the frames lacks it.
    pub points: Vec<Option<f64>>,
}

/// Clips whose full matrix has no more cells than this are checked without being asked: it takes a
/// fraction of a second.
const CHECKED_CELLS: u64 = 1 << 22;

/// Clips whose points are further apart than this on average, in metres, are different motions: of 240 pairs
/// of one class (squats, jogs, grabs, walks) none reaches 0.22, a squat and a lying down are 0.43 apart.
pub const DEFAULT_MAX_DISTANCE: f64 = 0.3;

/// Runs the command.
///
/// # Errors
/// [`Failure`] if a clip cannot be read or an output cannot be written.
pub fn run(args: &AlignArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let options = global.read_options()?;
    let outputs = Outputs::new(args)?;
    let (a, b) = (
        ClipRef::parse(args.a.as_os_str())?,
        ClipRef::parse(args.b.as_os_str())?,
    );
    let (a, b) = (Take::load(&a, &options)?, Take::load(&b, &options)?);
    tell_warnings(voice, a.loaded.warnings.iter().chain(&b.loaded.warnings));
    tell_filled(voice, a.loaded.filled.len() + b.loaded.filled.len());
    let how = How {
        set: NamedSet::find(args.set.as_deref().unwrap_or(DEFAULT_SET))?.set,
        rate: args.rate.map(FrameRate::hz),
        margin: args.margin,
        max_distance: args.max_distance,
        check: args.check,
    };
    let mut result = align_takes(&a, &b, &how)?;
    if let Some(alignment) = &result.alignment {
        result.files = outputs.write(&result, alignment, (&a, &b))?;
    }
    let outcome = Outcome {
        found: result.alignment.is_some(),
        result,
        skipped: Vec::new(),
    };
    voice.report("align", &outcome, |out| tell(out, &outcome.result))
}

/// How two clips are aligned.
#[derive(Clone, Debug)]
pub struct How {
    /// Whose segments guide the alignment.
    pub set: FeatureSet,
    /// Poses per second to compare, at most the lower of the clips' own rates, which is the default.
    pub rate: Option<f64>,
    /// How far around the aligned segments the path may lie, in seconds.
    pub margin: f64,
    /// Clips whose points are further apart on average are too different, in metres.
    pub max_distance: f64,
    /// Whether the full matrix is computed however large.
    pub check: bool,
}

impl How {
    /// The usual way.
    #[must_use]
    pub fn new(set: FeatureSet) -> How {
        How {
            set,
            rate: None,
            margin: DEFAULT_MARGIN_SECONDS,
            max_distance: DEFAULT_MAX_DISTANCE,
            check: false,
        }
    }
}

/// Aligns two clips, and writes nothing.
///
/// # Errors
/// [`Failure`] for a rate that does not fit, or clips too long for the memory.
pub fn align_takes(a: &Take, b: &Take, how: &How) -> Result<AlignResult, Failure> {
    let lower = a.rate().min(b.rate());
    let rate = how.rate.unwrap_or(lower);
    if rate > lower {
        return Err(Failure::Usage(format!(
            "expected a --rate of at most {lower}, the lower of the clips' own, found {rate}"
        )));
    }
    let mut result = AlignResult {
        a: SideJson::new(a, None),
        b: SideJson::new(b, None),
        rate,
        points: Vec::new(),
        alignment: None,
        reason: None,
        files: Vec::new(),
    };
    let pair = match Pair::new(a, b, &how.set, rate)? {
        Ok(pair) => pair,
        Err(too_few) => {
            result.reason = Some(too_few.to_string());
            return Ok(result);
        }
    };
    (result.a, result.b) = (
        SideJson::new(a, Some(&pair.a)),
        SideJson::new(b, Some(&pair.b)),
    );
    result.points = pair.points.iter().map(|point| point.name()).collect();
    let resolution = Resolution {
        margin: how.margin,
        ..Resolution::new(rate)
    };
    let too_large = |e: DtwError| Failure::input(&a.clip.path, e);
    let found = align(pair.a.side(), pair.b.side(), &resolution).map_err(too_large)?;
    let Some(alignment) = found else {
        let without = if pair.a.frames.is_empty() { a } else { b };
        result.reason = Some(format!(
            "{}: no frame has a root and more than half of the body; --fill may help",
            without.clip.display()
        ));
        return Ok(result);
    };
    let mean = alignment.cost / alignment.steps.len() as f64;
    if mean > how.max_distance {
        result.reason = Some(format!(
            "the clips are too different: even when aligned their joints are {mean:.3} m apart on average, \
            more than --max-distance {}",
            how.max_distance
        ));
        return Ok(result);
    }
    let full = if how.check || alignment.cells.full <= CHECKED_CELLS {
        full_cost(&pair.a.poses, &pair.b.poses).map_err(too_large)?
    } else {
        None
    };
    let rates = (a.rate(), b.rate());
    result.alignment = Some(AlignmentJson::new(&alignment, &pair, full, rates));
    Ok(result)
}

impl SideJson {
    fn new(take: &Take, posed: Option<&Posed>) -> SideJson {
        SideJson {
            clip: take.clip.display(),
            start: take.span.start,
            end: take.span.end,
            rate: take.rate(),
            poses: posed.map_or(0, |posed| posed.frames.len()),
            left_out: posed.map_or(0, |posed| posed.left_out),
        }
    }
}

impl AlignmentJson {
    fn new(
        alignment: &Alignment,
        pair: &Pair,
        full_cost: Option<f64>,
        rates: (f64, f64),
    ) -> AlignmentJson {
        let step = |&(i, j): &(usize, usize)| {
            let (a, b) = (pair.a.frames[i], pair.b.frames[j]);
            StepJson {
                a,
                b,
                a_s: a as f64 / rates.0,
                b_s: b as f64 / rates.1,
                cost: pair.a.poses.distance(i, &pair.b.poses, j),
                points: pair.a.poses.distances(i, &pair.b.poses, j),
            }
        };
        let path: Vec<StepJson> = alignment.steps.iter().map(step).collect();
        let mean = |point: usize| {
            let known: Vec<f64> = path.iter().filter_map(|step| step.points[point]).collect();
            (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
        };
        let excess = |full: f64| match alignment.cost - full {
            // Both are the same path, or paths that tie.
            above if above <= 0.0 => 0.0,
            above => above / full,
        };
        AlignmentJson {
            cost: alignment.cost,
            mean_distance: alignment.cost / path.len() as f64,
            cells: CellsJson::new(alignment.cells),
            full_cost,
            excess: full_cost.map(excess),
            point_distances: (0..pair.points.len()).map(mean).collect(),
            path,
        }
    }
}

impl CellsJson {
    fn new(cells: Cells) -> CellsJson {
        CellsJson {
            segments: cells.segments,
            bands: cells.bands,
            full: cells.full,
            share: cells.share(),
        }
    }
}

/// Points listed as the most different.
const POINTS_SHOWN: usize = 5;

fn tell(out: &mut dyn Write, result: &AlignResult) -> io::Result<()> {
    let Some(found) = &result.alignment else {
        return writeln!(
            out,
            "{}",
            result.reason.as_deref().unwrap_or("no alignment")
        );
    };
    for side in [&result.a, &result.b] {
        let seconds = (side.end - side.start) as f64 / side.rate;
        write!(
            out,
            "{}: {} at {} Hz, {seconds:.2} s",
            side.clip,
            count(side.end - side.start, "frame"),
            side.rate
        )?;
        match side.left_out {
            0 => writeln!(out)?,
            n => writeln!(out, "; {} without a pose left out", count(n, "frame"))?,
        }
    }
    let steps = count(found.path.len(), "step");
    let (mean, cost) = (found.mean_distance, found.cost);
    writeln!(
        out,
        "{steps} at {} Hz, joints {mean:.3} m apart on average (cost {cost:.3})",
        result.rate
    )?;
    let cells = found.cells;
    let percent = |n: u64| 100.0 * n as f64 / cells.full as f64;
    writeln!(
        out,
        "{:.1} % of {} cells computed: segments {:.1} %, bands {:.1} %",
        100.0 * cells.share,
        cells.full,
        percent(cells.segments),
        percent(cells.bands)
    )?;
    match (found.full_cost, found.excess) {
        (Some(full), Some(excess)) => {
            writeln!(
                out,
                "full DTW costs {full:.3}: the band costs {:.2} % more",
                100.0 * excess
            )?;
        }
        _ => writeln!(out, "not compared with full DTW; --check does so")?,
    }
    let mut points: Vec<(f64, &str)> = Vec::new();
    for (distance, name) in found.point_distances.iter().zip(&result.points) {
        points.extend(distance.map(|distance| (distance, *name)));
    }
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let shown = points
        .iter()
        .take(POINTS_SHOWN)
        .map(|(d, name)| format!("{name} {d:.3} m"));
    writeln!(
        out,
        "most different: {}",
        shown.collect::<Vec<_>>().join(", ")
    )?;
    for file in &result.files {
        writeln!(out, "{file}")?;
    }
    Ok(())
}
