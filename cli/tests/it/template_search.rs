//! Template search on the built-in corpus: against matching every clip by hand.

use std::ops::Range;

use cli::args::{DEFAULT_TAU, MatchingArgs, Tau};
use cli::commands::search::template::{Places, TemplateHitJson, TemplateResult, What, search};
use cli::corpus::Class;
use cli::keyframes;
use cli::library::{Clip, Library};
use cli::output::Voice;
use mtemplate::{
    AutomaticConfig, ClassTemplate, ExampleConfig, Examples, Keyframe, LearnConfig, MatchConfig,
    MotionTemplate, Preselection, ShortClips, learn, learn_keyframes,
};
use ndarray::{Array1, Axis};

use crate::corpus::Fixture;

/// The papers' quantisation threshold.
const DELTA: f64 = 0.1;

/// The library of the corpus, its clips and their words.
pub(crate) struct Corpus {
    library: Library,
    clips: Vec<(Clip, Vec<u64>)>,
}

impl Corpus {
    pub(crate) fn get() -> Corpus {
        let library = Library::open(&Fixture::get().library()).unwrap();
        let clips = library.clips().unwrap().into_iter();
        let clips = clips.map(|clip| {
            let words = library.words(clip.id).unwrap();
            (clip, words)
        });
        Corpus {
            clips: clips.collect(),
            library,
        }
    }

    /// Words of the first clips of a class, and of as many of all others.
    fn examples(&self, class: Class) -> [Vec<&[u64]>; 2] {
        let mut examples = [Vec::new(), Vec::new()];
        let files = Fixture::get()
            .files
            .iter()
            .filter(|file| file.class.is_some());
        for file in files.step_by(3) {
            let name = file.path.display().to_string();
            let (_, words) = self
                .clips
                .iter()
                .find(|(clip, _)| clip.name == name)
                .unwrap();
            examples[usize::from(file.class != Some(class))].push(words.as_slice());
        }
        examples
    }

    pub(crate) fn template(&self, class: Class) -> ClassTemplate {
        let set = &self.library.features.set;
        let features = set.features().iter().map(|feature| feature.name.clone());
        let features: Vec<String> = features.collect();
        let [motions, _] = self.examples(class);
        let motions: Vec<MotionTemplate> = motions
            .iter()
            .map(|words| MotionTemplate::from_words(words, features.len()).unwrap())
            .collect();
        ClassTemplate {
            name: class.name().to_owned(),
            feature_set: set.name().to_owned(),
            rate: self.library.rate,
            template: learn(&motions, &LearnConfig::default()).unwrap().template,
            n_motions: Some(motions.len()),
            features,
            tau: None,
            keyframes: Vec::new(),
        }
    }

    fn search(&self, template: &ClassTemplate, what: &What) -> TemplateResult {
        search(&self.library, template, what, Voice::default()).unwrap()
    }

    /// Clip, words and cost of all hits, in the order that they are to have; `stretches` gives the places to look at.
    fn by_hand(
        &self,
        template: &ClassTemplate,
        tau: f64,
        stretches: impl Fn(&[u64]) -> Vec<Range<usize>>,
    ) -> Vec<(String, Range<usize>, f64)> {
        let quantized = template.template.quantize(DELTA).unwrap();
        let mut hits = Vec::new();
        for (number, (clip, words)) in self.clips.iter().enumerate() {
            for stretch in stretches(words) {
                let words = &words[stretch.clone()];
                for found in quantized.find_matches(words, &MatchConfig::up_to(tau)) {
                    let span = found.span.start + stretch.start..found.span.end + stretch.start;
                    hits.push((found.cost, number, span, clip.name.clone()));
                }
            }
        }
        hits.sort_by(|a, b| {
            let rest = (a.1, a.2.start).cmp(&(b.1, b.2.start));
            a.0.total_cmp(&b.0).then(rest)
        });
        hits.into_iter()
            .map(|(cost, _, span, name)| (name, span, cost))
            .collect()
    }

    /// The same of a result, by way of frames of the files.
    fn assert_same(&self, result: &TemplateResult, expected: &[(String, Range<usize>, f64)]) {
        assert_eq!(result.n_hits, expected.len());
        assert_eq!(result.hits.len(), expected.len());
        for (i, (hit, (name, words, cost))) in result.hits.iter().zip(expected).enumerate() {
            let (clip, all) = self
                .clips
                .iter()
                .find(|(clip, _)| clip.name == *name)
                .unwrap();
            let meta = &clip.meta;
            let span = meta.source_span(words.clone(), all.len(), self.library.rate);
            assert_eq!(
                (&hit.clip, hit.start, hit.end),
                (name, span.start, span.end)
            );
            assert_eq!(hit.start_s, span.start as f64 / meta.source_rate);
            assert_eq!((hit.cost, hit.rank), (*cost, i + 1));
        }
    }
}

fn whole(words: &[u64]) -> Vec<Range<usize>> {
    std::iter::once(0..words.len()).collect()
}

#[test]
fn hits_are_those_of_every_clip() {
    let corpus = Corpus::get();
    for class in [Class::Squat, Class::KickLeft] {
        let template = corpus.template(class);
        let result = corpus.search(&template, &What::default());
        corpus.assert_same(&result, &corpus.by_hand(&template, DEFAULT_TAU, whole));
        assert!(result.n_hits > 0);
        let n_words: usize = corpus.clips.iter().map(|(_, words)| words.len()).sum();
        assert_eq!(
            (result.searched.words, result.searched.of),
            (n_words, n_words)
        );
        let top = corpus.search(
            &template,
            &What {
                top: 3,
                ..What::default()
            },
        );
        assert_eq!(top.hits, result.hits[..3]);
        assert_eq!(top.n_hits, result.n_hits);
    }
}

#[test]
fn around_keyframes_hits_are_those_of_the_stretches() {
    let corpus = Corpus::get();
    let mut template = corpus.template(Class::Squat);
    let set = &corpus.library.features.set;
    let automatic = keyframes::choose(&template, set, &AutomaticConfig::interactive()).unwrap();
    assert!(!automatic.is_empty());
    let by_hand = Keyframe {
        column: template.template.n_columns() / 2,
        care: set.select("rknee_bent").unwrap(),
        value: set.select("rknee_bent").unwrap(),
        stiffness: 1.0,
    };
    let everywhere = corpus.by_hand(&template, DEFAULT_TAU, whole);
    for (keyframes, places) in [
        (automatic, Places::Automatic),
        (vec![by_hand], Places::Around(vec![by_hand])),
    ] {
        let preselection = Preselection::new(&keyframes, template.template.n_columns()).unwrap();
        let stretches = |words: &[u64]| preselection.stretches(words);
        let what = What {
            places,
            explain_plan: true,
            ..What::default()
        };
        let result = corpus.search(&template, &what);
        let around = corpus.by_hand(&template, DEFAULT_TAU, stretches);
        corpus.assert_same(&result, &around);
        // The indexes give the stretches that the definition gives, frame by frame.
        let n_words = corpus.clips.iter().flat_map(|(_, words)| stretches(words));
        assert_eq!(
            result.searched.words,
            n_words.map(|stretch| stretch.len()).sum::<usize>()
        );
        assert!(result.searched.share < 0.5, "{:?}", result.searched);
        assert_eq!(result.query.keyframes.len(), keyframes.len());
        assert!(!result.plan.unwrap().is_empty());
        // Every hit of a whole clip that lies in a stretch is there, at the same cost.
        let mut n_kept = 0;
        for (name, span, cost) in &everywhere {
            let (_, words) = corpus
                .clips
                .iter()
                .find(|(clip, _)| clip.name == *name)
                .unwrap();
            let mut stretches = stretches(words).into_iter();
            if stretches.any(|stretch| stretch.start <= span.start && span.end <= stretch.end) {
                assert!(
                    around.contains(&(name.clone(), span.clone(), *cost)),
                    "{name} {span:?}"
                );
                n_kept += 1;
            }
        }
        assert!(n_kept > 0);
    }
    // A template's own keyframes come before chosen ones.
    template.keyframes = vec![by_hand];
    let own = corpus.search(
        &template,
        &What {
            places: Places::Automatic,
            ..What::default()
        },
    );
    assert_eq!(own.query.keyframes.len(), 1);
    assert_eq!(own.query.keyframes[0].one, ["rknee_bent"]);
}

#[test]
fn what_keyframes_lose_is_told() {
    let corpus = Corpus::get();
    let template = corpus.template(Class::Squat);
    let bent = corpus.library.features.set.select("rknee_bent").unwrap();
    // Knees are bent in the middle of a squat, but hardly ever at its first frame.
    let at = |column| Keyframe {
        column,
        care: bent,
        value: bent,
        stiffness: 1.0,
    };
    let everywhere = corpus.search(&template, &What::default());
    assert!(everywhere.n_hits > 0);
    assert_eq!(everywhere.lost, None);
    for column in [0, template.template.n_columns() / 2] {
        let what = What {
            places: Places::Around(vec![at(column)]),
            lost: true,
            ..What::default()
        };
        let result = corpus.search(&template, &what);
        let lost = result.lost.as_ref().unwrap();
        assert_eq!(lost.of, everywhere.n_hits);
        // Frame by frame: a hit is lost if no hit has half of its frames.
        let is_found = |one: &&TemplateHitJson| {
            result.hits.iter().any(|other| {
                let common = (one.start..one.end).filter(|f| (other.start..other.end).contains(f));
                other.clip == one.clip && 2 * common.count() >= one.end - one.start
            })
        };
        let expected: Vec<_> = everywhere
            .hits
            .iter()
            .filter(|hit| !is_found(hit))
            .collect();
        assert_eq!(lost.hits.iter().collect::<Vec<_>>(), expected);
        assert_eq!(lost.n_hits, expected.len());
        println!("column {column}: {} of {} lost", lost.n_hits, lost.of);
        assert!(lost.n_hits < lost.of);
        assert!(column > 0 || lost.n_hits > 0);
        let one = corpus.search(&template, &What { top: 1, ..what });
        let listed = lost.hits.len().min(1);
        assert_eq!(one.lost.unwrap().hits, lost.hits[..listed]);
    }
    // Without keyframes there is nothing to lose.
    let what = What {
        lost: true,
        ..What::default()
    };
    let lost = corpus.search(&template, &what).lost.unwrap();
    assert_eq!((lost.n_hits, lost.of), (0, everywhere.n_hits));
}

#[test]
fn short_clips_are_found_when_held() {
    let corpus = Corpus::get();
    // Three times as slow: no clip but the longest has half as many words.
    let mut template = corpus.template(Class::Squat);
    let columns: Vec<usize> = (0..template.template.n_columns())
        .flat_map(|k| [k; 3])
        .collect();
    let values = template.template.values().select(Axis(0), &columns);
    let weights = Array1::ones(columns.len());
    template.template = MotionTemplate::new(values, weights).unwrap();
    let [unmatched, held] = [ShortClips::Unmatched, ShortClips::Held].map(|short_clips| {
        let matching = MatchingArgs {
            tau: Some(Tau::Value(1.0)),
            delta: None,
        };
        let what = What {
            matching,
            short_clips,
            ..What::default()
        };
        corpus.search(&template, &what)
    });
    let is_short = |hit: &TemplateHitJson| {
        let clip = corpus.clips.iter().find(|(clip, _)| clip.name == hit.clip);
        clip.unwrap().1.len() <= columns.len() / 2
    };
    assert!(!unmatched.hits.iter().any(is_short));
    let (short, others): (Vec<_>, Vec<_>) = held.hits.iter().partition(|hit| is_short(hit));
    // Each of them once, and the others as ever.
    let n_short = corpus
        .clips
        .iter()
        .filter(|(_, words)| words.len() <= columns.len() / 2);
    assert_eq!(short.len(), n_short.count());
    assert!(short.iter().all(|hit| hit.start == 0));
    let span = |hit: &TemplateHitJson| (hit.clip.clone(), hit.start, hit.end, hit.cost);
    assert_eq!(
        others.into_iter().map(span).collect::<Vec<_>>(),
        unmatched.hits.iter().map(span).collect::<Vec<_>>()
    );
    assert!(!short.is_empty());
}

#[test]
fn keyframes_from_examples_lose_no_training_clip() {
    let corpus = Corpus::get();
    for class in [Class::Squat, Class::KickLeft] {
        let mut template = corpus.template(class);
        let quantized = template.template.quantize(DELTA).unwrap();
        let [positives, negatives] = corpus.examples(class);
        let examples = Examples {
            positives: &positives,
            negatives: &negatives,
        };
        let all = corpus.library.features.set.all();
        let learned = learn_keyframes(&quantized, &examples, &ExampleConfig::of_features(all));
        assert!(learned.kept < 0.2, "{class:?}: {}", learned.kept);
        template.keyframes = learned.keyframes;
        let everywhere = corpus.search(&template, &What::default());
        let what = What {
            places: Places::Automatic,
            ..What::default()
        };
        let around = corpus.search(&template, &what);
        println!(
            "{}: {:.3} searched, {} of {} hits",
            class.name(),
            around.searched.share,
            around.n_hits,
            everywhere.n_hits
        );
        let trained: Vec<&str> = corpus
            .clips
            .iter()
            .filter(|(_, words)| positives.contains(&words.as_slice()))
            .map(|(clip, _)| clip.name.as_str())
            .collect();
        for name in trained {
            let best = |result: &TemplateResult| {
                let hit = result.hits.iter().find(|hit| hit.clip == name);
                hit.map(|hit| (hit.start, hit.end, hit.cost))
            };
            assert_eq!(best(&around), best(&everywhere), "{name}");
        }
    }
}

#[test]
fn the_order_does_not_depend_on_the_number_of_threads() {
    let corpus = Corpus::get();
    let template = corpus.template(Class::Squat);
    let what = What {
        matching: MatchingArgs {
            tau: Some(Tau::Value(0.2)),
            delta: None,
        },
        places: Places::Automatic,
        ..What::default()
    };
    let [one, three] = [1, 3].map(|n| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap();
        pool.install(|| corpus.search(&template, &what)).hits
    });
    assert_eq!(one, three);
}
