//! Progress of a command on standard error: on a terminal a line that shows what is done at present, elsewhere only a line
//! for each finished scenario.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

use super::{
    exit::CliError,
    interrupt::{self, Interruptible},
    log, output,
};
use crate::{
    model::stop::Stop,
    pipeline::sweep::SweepWatch,
    planner::{Event, Part, Phase, Watch},
    report::{Outcome, console},
};

/// Interval at which the line is redrawn.
const TICK: Duration = Duration::from_millis(200);

/// What stays of a command that has found nothing.
const NOTHING_LEFT: &str = "nothing was found yet and nothing is written";
/// What stays of one whose finding was refused.
const UNCHECKED_LEFT: &str = "what was found did not pass its check, and nothing is written";

/// Every so many candidates their number is shown.
const CANDIDATES_SHOWN: u64 = 50;

/// The line of a command that runs scenarios or jobs: how many have ended.
const COUNTING: &str = "{spinner} {elapsed}  [{bar:30}] {pos}/{len}  {msg}";
/// The line of a phase whose size is known.
const MEASURED: &str = "{spinner} {elapsed}  [{bar:20}] {percent:>3} %  {msg}";
/// The line of a phase whose size is not known.
const OPEN: &str = "{spinner} {elapsed}  {msg}";

/// The progress of a command, and what Ctrl-C leaves of it.
pub struct Progress {
    bar: ProgressBar,
    begun: Instant,
    now: Mutex<Now>,
    /// True if the bar counts scenarios or jobs.
    counts: bool,
    /// True once there is something to keep after Ctrl-C.
    keeps: AtomicBool,
    /// What is done after Ctrl-C, if there is something to keep.
    ending: &'static str,
    /// What stays of a command that is ended before its end, in words, if it is not what usually stays.
    left: Mutex<Option<String>>,
}

/// What is done at present.
struct Now {
    /// The scenario or job of several that began last.
    item: Option<String>,
    /// What is done, in words.
    doing: String,
    /// How long that usually takes.
    usually: &'static str,
    /// Candidates of the present search.
    candidates: u64,
}

impl Now {
    fn words(&self) -> String {
        let parts = [self.item.as_deref(), Some(self.doing.as_str())];
        parts.into_iter().flatten().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ")
    }
}

impl Progress {
    /// The progress of a command that does `doing` at first, and its handler of Ctrl-C. After Ctrl-C it does as `ending` says
    /// if there is something to keep, and else ends at once.
    ///
    /// # Errors
    /// If the handler cannot be installed.
    pub fn begin(doing: &str, ending: &'static str) -> Result<Arc<Self>, CliError> {
        Self::new(doing, ending, None)
    }

    /// As [`Self::begin`], for a command whose bar counts scenarios or jobs; [`Self::expect`] tells how many there are.
    ///
    /// # Errors
    /// If the handler cannot be installed.
    pub fn counting(doing: &str, ending: &'static str) -> Result<Arc<Self>, CliError> {
        Self::new(doing, ending, Some(0))
    }

    fn new(doing: &str, ending: &'static str, items: Option<u64>) -> Result<Arc<Self>, CliError> {
        // indicatif hides the bar if standard error is not a terminal.
        let bar = if log::is_on() { ProgressBar::hidden() } else { ProgressBar::new(items.unwrap_or(0)) };
        let progress = Arc::new(Self {
            bar,
            begun: Instant::now(),
            now: Mutex::new(Now { item: None, doing: doing.to_owned(), usually: "", candidates: 0 }),
            counts: items.is_some(),
            keeps: AtomicBool::new(false),
            ending,
            left: Mutex::new(None),
        });
        progress.style(OPEN);
        progress.bar.set_message(doing.to_owned());
        if !progress.bar.is_hidden() {
            progress.bar.enable_steady_tick(TICK);
        }
        interrupt::listen(progress.clone())?;
        Ok(progress)
    }

    fn style(&self, template: &str) {
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style.progress_chars("=> "));
        }
    }

    /// The number of scenarios or jobs that the bar counts.
    pub fn expect(&self, items: usize) {
        self.style(COUNTING);
        self.bar.set_length(items as u64);
    }

    /// From now on Ctrl-C ends the command in order.
    pub fn keep(&self) {
        self.keeps.store(true, Ordering::SeqCst);
    }

    /// Says what stays of the command if it is ended from now on.
    pub fn leaves(&self, what: &str) {
        *self.left.lock().unwrap_or_else(PoisonError::into_inner) = Some(what.to_owned());
    }

    /// Shows that a scenario or a job has started.
    pub fn begins(&self, name: &str) {
        self.show(|now| now.item = Some(name.to_owned()));
    }

    /// Shows what is done now.
    pub fn does(&self, doing: &str) {
        self.show(|now| (now.doing, now.usually, now.candidates) = (doing.to_owned(), "", 0));
        if !self.counts {
            self.style(OPEN);
        }
    }

    /// Shows that a plan is simulated now. After Ctrl-C what it interrupted stays in the message.
    pub fn simulates(&self) {
        if !self.is_stopped() {
            self.does("simulating");
        }
    }

    /// Shows that a scenario has finished after `wall_s` seconds.
    pub fn ends(&self, outcome: &Outcome, wall_s: f64) {
        self.advances(Some(&format!("{} ({wall_s:.1} s)", console::line(outcome))));
    }

    /// Advances the bar by one and prints a line, if there is one.
    pub fn advances(&self, line: Option<&str>) {
        self.bar.inc(1);
        if let Some(line) = line {
            self.message(line);
        }
    }

    /// Prints a line on standard error, above the bar.
    pub fn message(&self, line: &str) {
        self.bar.suspend(|| output::message(line));
    }

    /// Prints text on standard output; the bar stays below it.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn print(&self, text: &str) -> Result<(), CliError> {
        self.bar.suspend(|| output::print(text))
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn with_now<R>(&self, of: impl FnOnce(&mut Now) -> R) -> R {
        // Whole values are assigned, so the words stay valid if a thread panics.
        of(&mut self.now.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Changes what is done at present, and shows it.
    fn show(&self, change: impl FnOnce(&mut Now)) {
        let message = self.with_now(|now| {
            change(now);
            let mut words = now.words();
            if now.candidates > 0 {
                words.push_str(&format!(", {} candidates", now.candidates));
            }
            if !now.usually.is_empty() {
                words.push_str(&format!("; {}", now.usually));
            }
            words
        });
        if !self.bar.is_hidden() {
            self.bar.set_message(message);
        }
    }

    fn part(&self, Part { phase, done, total }: Part) {
        if done == 0 {
            self.show(|now| {
                now.candidates = 0;
                now.usually = usually(phase);
                now.doing = phase.to_string();
            });
            if !self.counts {
                self.style(if total == 0 { OPEN } else { MEASURED });
            }
        }
        if !self.counts && total > 0 {
            self.bar.set_length(total);
            self.bar.set_position(done);
        }
    }

    fn search(&self, candidates: u64) {
        if candidates.is_multiple_of(CANDIDATES_SHOWN) && !self.bar.is_hidden() {
            self.show(|now| now.candidates = candidates);
        }
    }
}

/// How long the maps usually take, of which a phase is a part.
fn usually(phase: Phase) -> &'static str {
    match phase {
        Phase::GraspLibrary | Phase::Postures | Phase::NaturalGrasps | Phase::WarmStarts { .. } => {
            "all maps usually take 3 to 10 s"
        }
        _ => "",
    }
}

impl Stop for Progress {
    fn is_stopped(&self) -> bool {
        interrupt::requested()
    }
}

impl SweepWatch for Progress {
    fn finished_run(&self) {
        self.advances(None);
    }
}

impl Watch for Progress {
    fn tell(&self, event: &Event<'_>) {
        match event {
            Event::Part(part) => self.part(*part),
            Event::Search(progress) => self.search(progress.evaluations),
            Event::Found => self.keep(),
        }
    }
}

impl Interruptible for Progress {
    fn ending(&self) -> Option<&'static str> {
        self.keeps.load(Ordering::SeqCst).then_some(self.ending)
    }

    fn interrupted(&self) -> String {
        let elapsed_s = self.begun.elapsed().as_secs_f64();
        let doing = self.with_now(|now| now.words());
        let left = self.left.lock().unwrap_or_else(PoisonError::into_inner);
        let usually = if self.ending().is_some() { UNCHECKED_LEFT } else { NOTHING_LEFT };
        let left = left.as_deref().unwrap_or(usually);
        format!("interrupted after {elapsed_s:.1} s, while {doing}: {left}")
    }

    fn message(&self, line: &str) {
        Self::message(self, line);
    }

    fn finish(&self) {
        Self::finish(self);
    }
}
