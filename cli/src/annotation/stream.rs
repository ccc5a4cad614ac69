//! Labelling while frames come.

mod input;

use std::io::Read;

use mtemplate::{Match, MatchStream};
use relfeat::{WordStream, source_frame};

use self::input::{FrameLines, Input, Lines};
use super::{Group, Labelled, Labeller, Span};
use crate::failure::Failure;
use crate::recording::ReadOptions;
use crate::wire::available;

/// Templates that listen to a stream.
struct Listening<'a> {
    templates: Vec<(&'a Labelled, MatchStream)>,
    /// Source frames per second, and words per second.
    rates: [f64; 2],
    n_words: usize,
}

/// A stream that is read and labelled at once.
#[derive(Debug)]
pub struct Live<'a, R> {
    group: &'a Group,
    input: Input<R>,
}

impl<'a, R: Read> Live<'a, R> {
    /// Reads a stream up to its first frame.
    ///
    /// # Errors
    /// [`Failure`]: a stream that is none of those that are read; templates of more than one feature
    /// set or rate.
    pub fn open(labeller: &'a Labeller, stream: R, options: &ReadOptions) -> Result<Self, Failure> {
        let [group] = labeller.groups() else {
            return Err(Failure::Usage(
                "--stream: expected templates of one feature set and rate, found several"
                    .to_owned(),
            ));
        };
        let input = Input::open(Lines::new(stream), options)?;
        Ok(Live { group, input })
    }

    /// Frames per second of the stream; those of its words if it has no frames.
    #[must_use]
    pub fn rate(&self) -> f64 {
        match &self.input {
            Input::Words(_) => self.group.rate,
            Input::Frames(frames) => frames.rate,
        }
    }

    /// Labels that are not looked for, as the stream's rig lacks features that they ask for.
    #[must_use]
    pub fn lacking(&self) -> Vec<usize> {
        let lacking = self
            .group
            .templates
            .iter()
            .filter(|t| !self.can_be_asked(t));
        lacking.map(|t| t.label).collect()
    }

    fn can_be_asked(&self, template: &Labelled) -> bool {
        match &self.input {
            Input::Words(_) => true,
            Input::Frames(frames) => template.care & !available(&self.group.set, &frames.map) == 0,
        }
    }

    /// Reads to the end and gives each span once no frame to come can change it; of spans that become
    /// certain with the same word, those of the first label come first.
    ///
    /// # Errors
    /// [`Failure`] for a line that is no frame or word, and those of `each`.
    pub fn run(self, mut each: impl FnMut(Span) -> Result<(), Failure>) -> Result<(), Failure> {
        let asked = self.group.templates.iter().filter(|t| self.can_be_asked(t));
        let mut listening = Listening {
            templates: asked
                .map(|t| (t, MatchStream::new(&t.template, t.tau)))
                .collect(),
            rates: [self.rate(), self.group.rate],
            n_words: 0,
        };
        match self.input {
            Input::Words(mut lines) => {
                while let Some(words) = lines.next()? {
                    listening.hear(&words, &mut each)?;
                }
                let n_words = listening.n_words;
                listening.finish(n_words, &mut each)
            }
            Input::Frames(frames) => listening.watch(*frames, self.group, &mut each),
        }
    }
}

impl Listening<'_> {
    fn watch<R: Read>(
        mut self,
        mut frames: FrameLines<R>,
        group: &Group,
        each: &mut impl FnMut(Span) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let unfit = |e| Failure::Usage(format!("standard input: {e}"));
        let [rate, word_rate] = self.rates;
        let words = WordStream::new(group.set.clone(), frames.map.clone(), rate, word_rate);
        let mut words = words.map_err(unfit)?;
        let mut n_frames = 0;
        while let Some(more) = frames.next()? {
            n_frames += more.dim().0;
            self.hear(&words.push(more.view()).map_err(unfit)?, each)?;
        }
        self.hear(&words.finish(), each)?;
        self.finish(n_frames, each)
    }

    fn hear(
        &mut self,
        words: &[u64],
        each: &mut impl FnMut(Span) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for &word in words {
            self.n_words += 1;
            for (labelled, stream) in &mut self.templates {
                for found in stream.push(word) {
                    each(span(labelled, &found, self.rates))?;
                }
            }
        }
        Ok(())
    }

    /// A span that ends with the last word ends with the last frame.
    fn finish(
        self,
        n_frames: usize,
        each: &mut impl FnMut(Span) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for (labelled, stream) in self.templates {
            for found in stream.finish() {
                let mut span = span(labelled, &found, self.rates);
                if found.span.end == self.n_words {
                    span.frames.end = n_frames;
                }
                each(span)?;
            }
        }
        Ok(())
    }
}

fn span(labelled: &Labelled, found: &Match, [rate, word_rate]: [f64; 2]) -> Span {
    let frame = |word| source_frame(word, rate, word_rate);
    Span {
        label: labelled.label,
        frames: frame(found.span.start)..frame(found.span.end),
        cost: found.cost,
        tau: labelled.tau,
    }
}
