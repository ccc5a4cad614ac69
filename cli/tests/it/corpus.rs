//! The pipeline on the built-in corpus.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cli::args::{Mode, SetArgs};
use cli::commands::demo::SEED;
use cli::commands::index;
use cli::commands::search::{SearchResult, What, search};
use cli::corpus::Class;
use cli::corpus_files::{ClipFile, write_corpus};
use cli::library::Library;
use cli::output::{Outcome, Voice};
use cli::recording::{ReadOptions, load};
use cli::source::ClipRef;
use cli::wire::clip_words;
use mocap_io::{LengthUnit, write_bvh};
use relfeat::FeatureSet;
use tempfile::TempDir;

/// The corpus as files, and a library of it. Made once for all tests, read only.
pub(crate) struct Fixture {
    pub(crate) dir: TempDir,
    pub(crate) files: Vec<ClipFile>,
}

impl Fixture {
    pub(crate) fn get() -> &'static Fixture {
        static FIXTURE: OnceLock<Fixture> = OnceLock::new();
        FIXTURE.get_or_init(|| {
            let dir = tempfile::tempdir().unwrap();
            let files = write_corpus(&dir.path().join("corpus"), SEED, Voice::default()).unwrap();
            let fixture = Fixture { dir, files };
            build(&[fixture.corpus()], &fixture.library());
            fixture
        })
    }

    pub(crate) fn corpus(&self) -> PathBuf {
        self.dir.path().join("corpus")
    }

    pub(crate) fn library(&self) -> PathBuf {
        self.dir.path().join("library")
    }

    /// The first clip of a class by a performer.
    pub(crate) fn clip(&self, performer: &str, class: Class) -> PathBuf {
        let folder = self.corpus().join(performer);
        let mut files = self.files.iter().filter(|f| f.class == Some(class));
        files
            .find(|f| f.path.starts_with(&folder))
            .unwrap()
            .path
            .clone()
    }
}

pub(crate) fn index(
    paths: &[PathBuf],
    library: &Path,
    options: &ReadOptions,
) -> Outcome<index::IndexResult> {
    let what = index::What {
        set: &SetArgs::default(),
        sync: false,
    };
    index::index(paths, library, &what, options, Voice::default()).unwrap()
}

pub(crate) fn build(paths: &[PathBuf], library: &Path) {
    let options = ReadOptions::default();
    let outcome = index(paths, library, &options);
    assert!(outcome.skipped.is_empty(), "{:?}", outcome.skipped);
    assert!(
        outcome.result.warnings.is_empty(),
        "{:?}",
        outcome.result.warnings
    );
}

fn clip_ref(path: &Path) -> ClipRef {
    ClipRef {
        path: path.to_owned(),
        span: None,
    }
}

fn find(library: &Library, example: &Path, features: &[&str], mode: Mode) -> SearchResult {
    let features: Vec<String> = features.iter().map(|&f| f.to_owned()).collect();
    let what = What {
        mode,
        ..What::new(&features)
    };
    search(
        library,
        &clip_ref(example),
        &what,
        &ReadOptions::default(),
        Voice::default(),
    )
    .unwrap()
}

#[test]
fn the_corpus_reads_back_without_a_warning_and_has_all_clips() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    assert_eq!(library.clips().unwrap().len(), fixture.files.len());
    let labels = fs::read_to_string(fixture.corpus().join("labels.csv")).unwrap();
    let n_labels: usize = fixture.files.iter().map(|f| f.labels.len()).sum();
    assert_eq!(labels.lines().count(), n_labels + 1);
}

#[test]
fn a_library_does_not_depend_on_the_number_of_threads() {
    let fixture = Fixture::get();
    let folder = fixture.corpus().join("anna");
    let shards: Vec<Vec<u8>> = [1, 3]
        .iter()
        .map(|&n| {
            let dir = tempfile::tempdir().unwrap();
            let pool = rayon_pool(n);
            pool.install(|| build(std::slice::from_ref(&folder), dir.path()));
            fs::read(dir.path().join("shards/0001.shard")).unwrap()
        })
        .collect();
    assert_eq!(shards[0], shards[1]);
}

fn rayon_pool(n_threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap()
}

#[test]
fn the_same_seed_gives_the_same_files() {
    let fixture = Fixture::get();
    let again = tempfile::tempdir().unwrap();
    let files = rayon_pool(1)
        .install(|| write_corpus(again.path(), SEED, Voice::default()))
        .unwrap();
    for (one, other) in fixture.files.iter().zip(&files) {
        assert_eq!(
            fs::read(&one.path).unwrap(),
            fs::read(&other.path).unwrap(),
            "{}",
            one.path.display()
        );
    }
}

/// Hits of a masked query by definition: the runs of the masked words of each clip, compared one by
/// one with those of the example (2005 paper, sect. 5.2: an adaptive fuzzy hit is an exact hit of the
/// segmentation by the chosen features).
fn linear_scan(library: &Library, example: &[u64], care: u64) -> BTreeSet<(String, usize)> {
    let wanted: Vec<u64> = runs(example, care)
        .into_iter()
        .map(|(word, _)| word)
        .collect();
    let mut hits = BTreeSet::new();
    for clip in library.clips().unwrap() {
        let runs = runs(&library.words(clip.id).unwrap(), care);
        for window in runs.windows(wanted.len()) {
            if window.iter().map(|r| r.0).eq(wanted.iter().copied()) {
                hits.insert((clip.name.clone(), window[0].1));
            }
        }
    }
    hits
}

fn runs(words: &[u64], care: u64) -> Vec<(u64, usize)> {
    let mut runs: Vec<(u64, usize)> = Vec::new();
    for (frame, word) in words.iter().enumerate() {
        if runs.last().is_none_or(|r| r.0 != word & care) {
            runs.push((word & care, frame));
        }
    }
    runs
}

#[test]
fn an_indexed_search_equals_a_linear_scan() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let set = &library.features.set;
    let choices: [&[&str]; 5] = [
        &["F20", "F21", "F37"],
        &["F32"],
        &["F3", "F7"],
        &["lower"],
        &["F15", "F16"],
    ];
    let clips = library.clips().unwrap();
    let mut n_hits = 0;
    for class in Class::ALL {
        for features in choices {
            let example = fixture.clip("ben", class);
            let care = features
                .iter()
                .filter_map(|f| set.select(f))
                .fold(0, |a, b| a | b);
            let words = clip_words(
                &clip_ref(&example),
                &ReadOptions::default(),
                set,
                library.rate,
            )
            .unwrap()
            .words;
            let expected = linear_scan(&library, &words, care);
            let result = find(&library, &example, features, Mode::Adaptive);
            n_hits += result.n_hits;
            let found: BTreeSet<(String, usize)> = result
                .hits
                .iter()
                .map(|h| {
                    let meta = &clips.iter().find(|clip| clip.name == h.clip).unwrap().meta;
                    // The word that the first source frame of the hit belongs to.
                    let word = (h.start as f64 * library.rate / meta.source_rate).round() as usize;
                    (h.clip.clone(), word)
                })
                .collect();
            assert_eq!(found, expected, "{class} {features:?}");
        }
    }
    assert!(
        n_hits > 500,
        "only {n_hits} hits in all: the test says nothing"
    );
}

#[test]
fn an_example_finds_itself_first_in_every_mode() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    for mode in [Mode::Exact, Mode::Fuzzy, Mode::Adaptive] {
        // All features, so that fuzzy segments are single segments.
        let example = fixture.clip("dan", Class::Wave);
        let result = find(&library, &example, &[], mode);
        assert_eq!(Path::new(&result.hits[0].clip), example, "{mode:?}");
        assert_eq!((result.hits[0].cost, result.hits[0].rank), (0, 1));
        assert_eq!(
            (result.hits[0].start, result.hits[0].end),
            (result.query.start, result.query.end)
        );
    }
}

#[test]
fn kicks_with_the_left_foot_are_found_in_clips_and_takes() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let example = fixture.clip("anna", Class::KickLeft);
    let result = find(
        &library,
        &example,
        &["lfoot_raised", "lknee_bent"],
        Mode::Adaptive,
    );
    let is_kick = |clip: &str| {
        let file = fixture
            .files
            .iter()
            .find(|f| f.path == Path::new(clip))
            .unwrap();
        file.labels.iter().any(|l| l.class == Class::KickLeft)
    };
    assert!(result.hits.iter().all(|h| is_kick(&h.clip)));
    let n_clips = fixture
        .files
        .iter()
        .filter(|f| f.class == Some(Class::KickLeft))
        .count();
    assert!(result.n_clips >= n_clips, "{} of {n_clips}", result.n_clips);
}

/// Bits of an AMC file and of its conversion to BVH that agree. Files are written with four digits,
/// so only values that lie on a threshold may fall to the other side.
const SAME_MOTION: f64 = 0.999;

#[test]
fn a_motion_has_the_same_words_as_amc_and_as_bvh() {
    let fixture = Fixture::get();
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let dir = tempfile::tempdir().unwrap();
    let options = ReadOptions::default();
    for class in Class::ALL {
        let amc = fixture.clip("chiyo", class);
        let motion = load(&amc, &options).unwrap().recording;
        let motion = motion.motion().unwrap();
        let mut bytes = Vec::new();
        write_bvh(
            &motion.to_parent_offsets().in_unit(LengthUnit::CENTIMETRE),
            &mut bytes,
        )
        .unwrap();
        let bvh = dir.path().join("clip.bvh");
        fs::write(&bvh, bytes).unwrap();
        let of_amc = clip_words(&clip_ref(&amc), &options, &set, 30.0).unwrap();
        let of_bvh = clip_words(&clip_ref(&bvh), &options, &set, 30.0).unwrap();
        assert_eq!(of_amc.words.len(), of_bvh.words.len());
        assert_eq!(
            (of_amc.meta.rig.as_str(), of_bvh.meta.rig.as_str()),
            ("acclaim", "acclaim-bvh")
        );
        let pairs = of_amc.words.iter().zip(&of_bvh.words);
        let n_different: u32 = pairs.map(|(a, b)| (a ^ b).count_ones()).sum();
        let share = 1.0 - f64::from(n_different) / (39.0 * of_amc.words.len() as f64);
        assert!(share >= SAME_MOTION, "{class}: {share}");
    }
}

#[test]
fn a_span_of_a_clip_is_searched_in_source_frames() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let take = fixture.files.iter().find(|f| f.class.is_none()).unwrap();
    let kick = take
        .labels
        .iter()
        .find(|l| l.class == Class::KickRight)
        .unwrap();
    let example = format!(
        "{}@{}-{}",
        take.path.display(),
        kick.span.start,
        kick.span.end
    );
    let example = ClipRef::parse(example.as_ref()).unwrap();
    let features = ["F17".to_owned(), "F20".to_owned()];
    let what = What::new(&features);
    let result = search(
        &library,
        &example,
        &what,
        &ReadOptions::default(),
        Voice::default(),
    )
    .unwrap();
    assert_eq!(
        (result.query.start, result.query.end),
        (kick.span.start, kick.span.end)
    );
    let own = result
        .hits
        .iter()
        .find(|h| Path::new(&h.clip) == take.path)
        .unwrap();
    assert!(
        own.start <= kick.span.start && own.end >= kick.span.end,
        "{own:?}"
    );
    // Runs grow to their full length on both sides; what is between them is the same.
    let inner = |segments: &[[usize; 2]]| segments[1..segments.len() - 1].to_vec();
    assert_eq!(inner(&own.segments), inner(&result.query.segments));
}
