//! ρ = 2 beside ρ = 1.

use anyhow::Result;
use bundles::{ExtractOptions, Partition, SeedInstance, extract};
use cli::output::table;

use crate::stages::{self, Clips, Smooth};
use crate::takes::{CLOSURES, How, METHODS, Set, Sets, percent};

/// Bundles of boxing at ρ = 2 that section 5 tells of: height and mean frames.
const BOXING: &str = "6x69 3x89 2x51 4x42 6x23";

/// The biases.
const RHOS: [f64; 2] = [1.0, 2.0];

/// Seeds of the instances that bundles grow from.
const SEEDS: u64 = 10;

/// Bundles shown.
const SHOWN: usize = 4;

/// Partitions of one string in numbers, each a mean over seeds.
#[derive(Clone, Copy, Default)]
struct Shape {
    bundles: f64,
    submotions: f64,
    /// Submotions of a bundle, on average.
    height: f64,
    /// Frames of a submotion, on average.
    frames: f64,
    /// The fewest bundles that have half of the frames of all bundles.
    half: f64,
    /// Of all frames, of those in a bundle.
    share: f64,
}

impl Shape {
    fn of(partition: &Partition, n_frames: usize) -> Shape {
        let mut areas: Vec<f64> = partition.bundles.iter().map(area).collect();
        areas.sort_by(|a, b| b.total_cmp(a));
        let all: f64 = areas.iter().sum();
        let mut sum = 0.0;
        let before_half = areas.iter().take_while(|area| {
            sum += **area;
            sum < all / 2.0
        });
        let half = (before_half.count() + 1).min(areas.len());
        let submotions: usize = partition.bundles.iter().map(|b| b.members.len()).sum();
        let bundles = areas.len().max(1) as f64;
        Shape {
            bundles: areas.len() as f64,
            submotions: submotions as f64,
            height: submotions as f64 / bundles,
            frames: all / submotions.max(1) as f64,
            half: half as f64,
            share: all / n_frames as f64,
        }
    }

    fn mean(shapes: &[Shape]) -> Shape {
        let mean = |of: fn(&Shape) -> f64| shapes.iter().map(of).sum::<f64>() / shapes.len() as f64;
        Shape {
            bundles: mean(|s| s.bundles),
            submotions: mean(|s| s.submotions),
            height: mean(|s| s.height),
            frames: mean(|s| s.frames),
            half: mean(|s| s.half),
            share: mean(|s| s.share),
        }
    }
}

/// The frames of a bundle.
fn area(bundle: &bundles::StringBundle) -> f64 {
    bundle.members.len() as f64 * bundle.mean_width
}

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let mut text = format!(
        "Bias: rho 2 prefers longer submotions, at the expense of motions in a bundle. Of the same letters, mean of {SEEDS} seeds of \
         the instances that bundles grow from, or from all letters, which no seed changes; height: motions in a bundle; half in: the \
         fewest bundles that have half of the frames of all; largest: height x frames, of the first seed. About as many frames are in \
         bundles, so that these become fewer only where motions are longer by more than bundles are lower. The paper's boxing at rho 2: {BOXING}\n"
    );
    for (method, how) in METHODS {
        text += &of_method(sets, method, how)?;
    }
    Ok(text + "\n")
}

fn of_method(sets: &Sets, method: &str, how: How) -> Result<String> {
    let mut rows = table(&[
        method,
        "closure",
        "from",
        "bundles",
        "",
        "motions",
        "",
        "height",
        "",
        "frames",
        "",
        "half in",
        "",
        "in bundles",
        "",
        "fewer",
        "lower",
        "longer",
        "largest at 2",
    ]);
    let biases = ["1", "2"].into_iter().cycle().take(12);
    rows.add_row(["rho", "", ""].into_iter().chain(biases).chain([""; 4]));
    let (mut n_ways, mut motions, mut fewer, mut lower, mut longer) = (0, 0, 0, 0, 0);
    for set in sets.all() {
        for (cells, [one, two]) in of_set(set, how)? {
            let is = [
                two.bundles < one.bundles,
                two.height < one.height,
                two.frames > one.frames,
            ];
            n_ways += 1;
            motions += usize::from(two.submotions < one.submotions);
            fewer += usize::from(is[0]);
            lower += usize::from(is[1]);
            longer += usize::from(is[2]);
            let [closure, from, largest] = cells;
            let mut row = vec![set.name.to_owned(), closure, from];
            for of in [
                |s: &Shape| format!("{:.1}", s.bundles),
                |s: &Shape| format!("{:.1}", s.submotions),
                |s: &Shape| format!("{:.2}", s.height),
                |s: &Shape| format!("{:.1}", s.frames),
                |s: &Shape| format!("{:.1}", s.half),
                |s: &Shape| percent(s.share),
            ] {
                row.extend([of(&one), of(&two)]);
            }
            row.extend(is.map(|is| if is { "yes" } else { "no" }.to_owned()));
            row.push(largest);
            rows.add_row(row);
        }
    }
    Ok(format!(
        "{}\nOf {n_ways}, fewer bundles in {fewer}, fewer motions in {motions}, lower bundles in {lower}, longer motions in {longer}\n",
        rows.trim_fmt()
    ))
}

/// Closure, where bundles grow from, and the largest at ρ = 2, with the shapes of both biases.
fn of_set(set: &Set, how: How) -> Result<Vec<([String; 3], [Shape; 2])>> {
    let (vectors, ranges) = set.vectors()?;
    let clips = Clips {
        vectors: vectors.view(),
        ranges: &ranges,
    };
    let smooth = Smooth::new(clips, set.rate()?, how);
    let letters = smooth.letters(set.kappa, 0, &mut |_| ())?;
    let (string, access) = smooth.spelt(&letters, None)?;
    let mut found = Vec::new();
    for (name, closure) in CLOSURES {
        let frequent = (0..SEEDS).map(SeedInstance::Random).collect();
        for (from, seeds) in [("frequent", frequent), ("all", vec![SeedInstance::Largest])] {
            let partitions = |rho: f64| -> Result<Vec<Partition>> {
                let of_seed = |&seed: &SeedInstance| {
                    let options = ExtractOptions {
                        rho,
                        seed,
                        ..stages::options(&string, closure, 0)
                    };
                    Ok(extract(&string, &access, &options)?)
                };
                seeds.iter().map(of_seed).collect()
            };
            let [one, two] = RHOS.map(partitions);
            let [one, two] = [one?, two?];
            let shape = |of: &[Partition]| {
                let shapes = of
                    .iter()
                    .map(|partition| Shape::of(partition, set.n_frames()));
                Shape::mean(&shapes.collect::<Vec<_>>())
            };
            let cells = [name.to_owned(), from.to_owned(), largest(&two)];
            found.push((cells, [shape(&one), shape(&two)]));
        }
    }
    Ok(found)
}

/// The largest bundles of the first partition.
fn largest(partitions: &[Partition]) -> String {
    let bundles = partitions.first().map_or(&[][..], |first| &first.bundles);
    let mut bundles: Vec<_> = bundles.iter().collect();
    bundles.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    let size = |bundle: &&bundles::StringBundle| {
        format!("{}x{:.0}", bundle.members.len(), bundle.mean_width)
    };
    let sizes: Vec<String> = bundles.iter().take(SHOWN).map(size).collect();
    sizes.join(" ")
}
