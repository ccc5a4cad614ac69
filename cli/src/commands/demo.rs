//! `motif demo`.

mod alignment;
mod report;
mod templates;

pub use alignment::DemoAlignment;
pub use report::DemoReport;
use report::Toured;
pub use templates::{DemoAnnotation, DemoTake};

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ndarray::s;
use serde::Serialize;

use super::index::{self, IndexResult, index};
use super::search::{HitJson, SearchResult, What, search};
use crate::args::{DemoArgs, Global, SetArgs};
use crate::corpus::{Class, Label};
use crate::corpus_files::{ClipFile, write_corpus};
use crate::failure::{Exit, Failure};
use crate::library::Library;
use crate::output::{Outcome, Voice, count, table};
use crate::picture::Image;
use crate::picture::heatmap::feature_heatmap;
use crate::picture::strip::{StripConfig, contact_sheet, skeleton_strip, strokes, three_quarter};
use crate::recording::{ReadOptions, load};
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::wire::clip_words;

/// The seed of the corpus unless another is asked for.
pub const SEED: u64 = 2006;

/// A search of the tour: an example, and what about it matters.
struct Stop {
    class: Class,
    features: &'static [&'static str],
    question: &'static str,
}

const STOPS: [Stop; 3] = [
    Stop {
        class: Class::Squat,
        features: &["rknee_bent", "lknee_bent", "vertical_extent_small"],
        question: "who bends both knees, gets low, and comes up again?",
    },
    Stop {
        class: Class::KickLeft,
        features: &["lfoot_raised", "lknee_bent"],
        question: "who bends the left knee and raises the left foot?",
    },
    Stop {
        class: Class::LieDown,
        features: &["spine_horizontal"],
        question: "whose spine becomes horizontal and stays so?",
    },
];

/// Hits shown per search.
const SHOWN: usize = 6;

/// What the tour made and found.
#[derive(Debug, Serialize)]
pub struct DemoResult {
    /// Where everything is.
    pub dir: String,
    /// What was indexed.
    pub index: IndexResult,
    /// The searches.
    pub searches: Vec<DemoSearch>,
    /// The takes, labelled by templates.
    pub annotation: DemoAnnotation,
    /// Two walks, aligned.
    pub alignment: DemoAlignment,
    /// The pictures.
    pub pictures: Vec<String>,
    /// All of it on one page.
    pub report: DemoReport,
}

/// A search of the tour, and how it did against the corpus's labels.
#[derive(Debug, Serialize)]
pub struct DemoSearch {
    /// The class of the example.
    pub class: &'static str,
    /// Labelled performances of the class, in single clips and in takes.
    pub performances: usize,
    /// How many of them some hit covers.
    pub found: usize,
    /// Hits that cover none.
    pub wrong: usize,
    /// What was asked and all hits.
    pub search: SearchResult,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if the folder cannot be written.
pub fn run(args: &DemoArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let dir = match &args.dir {
        Some(dir) => dir.clone(),
        None => std::env::temp_dir().join("motif-demo"),
    };
    prepare(&dir)?;
    let corpus = Corpus {
        files: write_corpus(&dir.join("corpus"), args.seed, voice)?,
        dir: dir.join("corpus"),
    };
    let library_dir = dir.join("library");
    let what = index::What {
        set: &SetArgs::default(),
        sync: false,
    };
    let options = ReadOptions::default();
    let paths = [corpus.dir.clone()];
    let indexed = index(&paths, &library_dir, &what, &options, voice)?;
    let library = Library::open(&library_dir)?;
    let searches: Result<Vec<DemoSearch>, Failure> = STOPS
        .iter()
        .map(|stop| corpus.ask(&library, stop, voice))
        .collect();
    let searches = searches?;
    let strips = dir.join("strips.png");
    write_picture(&strips, &corpus.strips(&searches)?)?;
    let heatmap = dir.join("features.png");
    write_picture(&heatmap, &corpus.heatmap(&library)?)?;
    let templates = dir.join("templates");
    let annotation = DemoAnnotation::new(&corpus.files, &templates, voice)?;
    let template = dir.join("template.png");
    let squat = DemoAnnotation::picture(&templates, Class::Squat)?;
    write_picture(&template, &squat)?;
    let alignment = DemoAlignment::new(&corpus.files)?;
    let toured = Toured {
        files: &corpus.files,
        searches: &searches,
        templates: &templates,
        alignment: &alignment.result,
    };
    let report = DemoReport::new(&dir, library, &toured, voice)?;
    let outcome = Outcome {
        result: DemoResult {
            dir: dir.display().to_string(),
            index: indexed.result,
            report,
            searches,
            annotation,
            alignment,
            pictures: [&strips, &heatmap, &template]
                .map(|p| p.display().to_string())
                .to_vec(),
        },
        skipped: indexed.skipped,
        found: true,
    };
    let result = &outcome.result;
    voice.report("demo", &outcome, |out| corpus.tell(out, result))
}

/// Makes the folder of the tour. What an earlier tour left there is replaced; anything else is not
/// touched.
fn prepare(dir: &Path) -> Result<(), Failure> {
    let library = dir.join("library");
    let is_ours =
        library.join("library.toml").exists() && dir.join("corpus").join("labels.csv").exists();
    let has_content = fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some());
    if is_ours {
        for old in [dir.join("corpus"), library, dir.join("templates")] {
            match fs::remove_dir_all(&old) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(Failure::io(&old, e)),
                _ => {}
            }
        }
    } else if has_content {
        let message = format!(
            "{} is neither empty nor an earlier demo; choose another --dir",
            dir.display()
        );
        return Err(Failure::Usage(message));
    }
    fs::create_dir_all(dir).map_err(|e| Failure::io(dir, e))
}

/// The files of the tour with their labels.
struct Corpus {
    dir: PathBuf,
    files: Vec<ClipFile>,
}

impl Corpus {
    fn ask(&self, library: &Library, stop: &Stop, voice: Voice) -> Result<DemoSearch, Failure> {
        let example = self.files.iter().find(|f| f.class == Some(stop.class));
        let example = example.ok_or_else(|| Failure::input(&self.dir, "a class without a clip"))?;
        let features: Vec<String> = stop.features.iter().map(|&f| f.to_owned()).collect();
        let what = What::new(&features);
        let clip = ClipRef {
            path: example.path.clone(),
            span: None,
        };
        let search = search(library, &clip, &what, &ReadOptions::default(), voice)?;
        let performances: Vec<(&Path, &Label)> = self
            .files
            .iter()
            .flat_map(|f| f.labels.iter().map(|label| (f.path.as_path(), label)))
            .filter(|(_, label)| label.class == stop.class)
            .collect();
        let is_found = |path: &Path, label: &Label| {
            search
                .hits
                .iter()
                .any(|h| Path::new(&h.clip) == path && covers(h, label))
        };
        let found = performances
            .iter()
            .filter(|(path, label)| is_found(path, label))
            .count();
        let wrong = search
            .hits
            .iter()
            .filter(|h| self.label(h, stop.class).is_none())
            .count();
        Ok(DemoSearch {
            class: stop.class.name(),
            performances: performances.len(),
            found,
            wrong,
            search,
        })
    }

    fn file(&self, clip: &str) -> Option<&ClipFile> {
        self.files.iter().find(|f| f.path == Path::new(clip))
    }

    /// The label of this class that the hit covers.
    fn label(&self, hit: &HitJson, class: Class) -> Option<&Label> {
        let labels = &self.file(&hit.clip)?.labels;
        labels.iter().find(|l| l.class == class && covers(hit, l))
    }

    /// What the hit shows: the label that it shares most frames with.
    fn shows(&self, hit: &HitJson) -> &'static str {
        let labels = self.file(&hit.clip).map_or(&[][..], |f| &f.labels);
        let best = labels.iter().max_by_key(|l| shared(hit, l));
        best.filter(|l| shared(hit, l) > 0)
            .map_or("-", |l| l.class.name())
    }

    /// The clip's path as it is read in tables.
    fn short(&self, clip: &str) -> String {
        let path = Path::new(clip);
        path.strip_prefix(&self.dir)
            .unwrap_or(path)
            .display()
            .to_string()
    }

    /// For each search the example, its best hit by somebody else, and its best hit in a take.
    fn strips(&self, searches: &[DemoSearch]) -> Result<Image, Failure> {
        let mut rows = Vec::new();
        for one in searches {
            let query = &one.search.query;
            let whole = Span {
                start: query.start,
                end: query.end,
            };
            rows.push((
                format!("{} example", one.class),
                strip(Path::new(&query.clip), whole)?,
            ));
            let performer = |clip: &str| Path::new(clip).parent().map(Path::to_owned);
            let is_take = |h: &&HitJson| self.file(&h.clip).is_some_and(|f| f.class.is_none());
            let mut hits = one.search.hits.iter();
            let other = hits.find(|h| performer(&h.clip) != performer(&query.clip) && !is_take(h));
            let take = one.search.hits.iter().find(is_take);
            for hit in other.into_iter().chain(take) {
                let caption = format!("{}, hit {}", self.short(&hit.clip), hit.rank);
                rows.push((caption, strip(Path::new(&hit.clip), near_core(hit))?));
            }
        }
        Ok(contact_sheet(&rows))
    }

    /// The features of the first take.
    fn heatmap(&self, library: &Library) -> Result<Image, Failure> {
        let take = self.files.iter().find(|f| f.class.is_none());
        let take = take.ok_or_else(|| Failure::input(&self.dir, "no take"))?;
        let clip = ClipRef {
            path: take.path.clone(),
            span: None,
        };
        let set = &library.features.set;
        let words = clip_words(&clip, &ReadOptions::default(), set, library.rate)?.words;
        Ok(feature_heatmap(
            &selection::names(set, set.all()),
            &words,
            library.rate,
        ))
    }

    fn tell(&self, out: &mut dyn Write, result: &DemoResult) -> io::Result<()> {
        let n_takes = self.files.iter().filter(|f| f.class.is_none()).count();
        writeln!(
            out,
            "Five procedural performers, {} kinds of motion: {} and {} in {}",
            Class::ALL.len(),
            count(self.files.len() - n_takes, "single clip"),
            count(n_takes, "long take"),
            self.dir.display()
        )?;
        let (index, total) = (&result.index, &result.index.total);
        writeln!(
            out,
            "{} frames read, {} segments indexed in {:.1} s: {}",
            index.frames, total.segments, index.seconds.total, index.library
        )?;
        for (stop, one) in STOPS.iter().zip(&result.searches) {
            self.tell_search(out, stop, one)?;
        }
        result.annotation.tell(out)?;
        result.alignment.tell(out)?;
        writeln!(out, "\npictures: {}", result.pictures.join(", "))?;
        self.tell_next(out, result)?;
        result.report.tell(out)
    }

    fn tell_search(&self, out: &mut dyn Write, stop: &Stop, one: &DemoSearch) -> io::Result<()> {
        let search = &one.search;
        writeln!(
            out,
            "\nLike {}: {}",
            self.short(&search.query.clip),
            stop.question
        )?;
        writeln!(
            out,
            "  features {}; {} of {} performances of {} found, {}",
            search.query.features.join(", "),
            one.found,
            one.performances,
            one.class,
            match one.wrong {
                0 => "no other motion".to_owned(),
                n => count(n, "other hit"),
            }
        )?;
        let mut rows = table(&["rank", "cost", "clip", "frames", "seconds", "shows"]);
        for hit in search.hits.iter().take(SHOWN) {
            rows.add_row([
                hit.rank.to_string(),
                hit.cost.to_string(),
                self.short(&hit.clip),
                format!("{}-{}", hit.start, hit.end),
                format!("{:.2}-{:.2}", hit.start_s, hit.end_s),
                self.shows(hit).to_owned(),
            ]);
        }
        for line in rows.trim_fmt().lines() {
            writeln!(out, "  {line}")?;
        }
        Ok(())
    }

    fn tell_next(&self, out: &mut dyn Write, result: &DemoResult) -> io::Result<()> {
        let program = std::env::args()
            .next()
            .unwrap_or_else(|| "motif".to_owned());
        let clip = |class: Class| {
            let file = self.files.iter().rev().find(|f| f.class == Some(class));
            file.map_or(String::new(), |f| f.path.display().to_string())
        };
        writeln!(out, "\nTry next:")?;
        let library = &result.index.library;
        for line in [
            format!(
                "search {library} --example {} --features F3 F7",
                clip(Class::Wave)
            ),
            format!(
                "search {library} --example {} --features F2 lelbow_bent",
                clip(Class::PunchLeft)
            ),
            format!(
                "search {library} --example {} --features F15 F16 --top 50",
                clip(Class::Walk)
            ),
            format!(
                "search {library} --scene \"rfoot_raised: 0 1 0; lelbow_bent: 1 0 1; \
                 before rfoot_raised[2] lelbow_bent[2]; within 4s\""
            ),
            format!(
                "search {library} --template {}/hop.mtpl --keyframes auto",
                result.annotation.templates
            ),
            format!(
                "template show {}/kick_left.mtpl",
                result.annotation.templates
            ),
            format!(
                "annotate {} --templates {} -o spans.csv",
                self.dir.display(),
                result.annotation.templates
            ),
            format!("features {} -o hop.png", clip(Class::Hop)),
            format!("info {}", clip(Class::Jog)),
            format!(
                "align {} {} -o path.csv",
                result.alignment.a, result.alignment.b
            ),
            "index FOLDER -o my.lib      (your own BVH, AMC and C3D files)".to_owned(),
        ] {
            writeln!(out, "  {program} {line}")?;
        }
        Ok(())
    }
}

/// Frames that hit and label share.
fn shared(hit: &HitJson, label: &Label) -> usize {
    let start = hit.start.max(label.span.start);
    hit.end.min(label.span.end).saturating_sub(start)
}

/// Whether hit and label share at least half of the shorter one.
fn covers(hit: &HitJson, label: &Label) -> bool {
    let shorter = (hit.end - hit.start).min(label.span.len());
    2 * shared(hit, label) >= shorter.max(1)
}

/// A hit with at most a second of its first and last segment: in a long take these reach from the
/// motion before to the motion behind.
fn near_core(hit: &HitJson) -> Span {
    let rate = (hit.end - hit.start) as f64 / (hit.end_s - hit.start_s).max(f64::MIN_POSITIVE);
    let second = rate.round() as usize;
    let first = hit.segments.first().map_or(hit.start, |s| s[1]);
    let last = hit.segments.last().map_or(hit.end, |s| s[0]);
    Span {
        start: hit.start.max(first.saturating_sub(second)),
        end: hit.end.min(last + second),
    }
}

/// Poses of a span, as the readers see the file.
fn strip(path: &Path, span: Span) -> Result<Image, Failure> {
    let recording = load(path, &ReadOptions::default())?.recording;
    let positions = recording.positions();
    let names = recording.names();
    let bones = recording.bones();
    let find = |name: &str| names.iter().position(|n| *n == name).unwrap_or(0);
    let cut = positions.slice(s![span.range(), .., ..]);
    let camera = three_quarter(
        cut,
        find("lfemur"),
        find("rfemur"),
        StripConfig::default().camera,
    );
    let config = StripConfig {
        camera,
        ..StripConfig::default()
    };
    Ok(skeleton_strip(cut, &strokes(&names, &bones), &config))
}

fn write_picture(path: &Path, image: &Image) -> Result<(), Failure> {
    let png = image.to_png().map_err(|e| Failure::input(path, e))?;
    fs::write(path, png).map_err(|e| Failure::io(path, e))
}
