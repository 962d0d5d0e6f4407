//! Runs the cases of a target. A case is a folder of files; it is made of a valid one and a seed, and of nothing else.

use std::{
    any::Any,
    env, fs,
    panic::{self, AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    process,
    sync::{Arc, Mutex, Once},
    thread,
    time::{Duration, Instant},
};

use benchdog::input::is_decoding;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;

use crate::mutate::Mutator;

/// A case that takes longer ends the tests: its thread cannot be stopped.
const LONGEST: Duration = Duration::from_secs(20);

/// The most mutations of a case.
const MOST_MUTATIONS: usize = 4;

/// The most failures of a target that are collected before it ends.
const MOST_FAILURES: usize = 20;

/// The files of a case by their names. The target reads the first one.
pub type Files = Vec<(String, Vec<u8>)>;

/// What is given damaged files.
pub struct Target {
    /// Its name, that of its folder in the corpus.
    pub name: &'static str,
    /// Valid cases, of which others are made by mutations.
    pub valid: Vec<Files>,
    /// How many cases `cargo test` runs.
    pub cases: u64,
    /// Mutates a file in a way of the format's own; false if it leaves it to the general ones.
    pub mutate: fn(&mut Vec<u8>, &mut Pcg64) -> bool,
    /// Reads the file of this name in a folder. The error says what must not be; so does a panic.
    pub run: fn(&Path, &str) -> Result<(), String>,
}

/// Which cases are run.
enum Wanted {
    /// Those of `cargo test`.
    Short,
    /// As many as fit into this time, from a first seed on.
    For { time: Duration, first: u64 },
    /// One, whose files stay.
    Again { seed: u64 },
    /// No case of this target.
    Nothing,
}

impl Wanted {
    /// `BENCHDOG_FUZZ=TARGET:SEED`, or `BENCHDOG_FUZZ_SECONDS` and `BENCHDOG_FUZZ_SEED`.
    fn of(target: &str) -> Self {
        let number = |name: &str| env::var(name).ok().map(|text| text.parse().expect("a whole number"));
        if let Ok(case) = env::var("BENCHDOG_FUZZ") {
            let (name, seed) = case.split_once(':').expect("TARGET:SEED");
            return if name == target { Self::Again { seed: seed.parse().expect("a seed") } } else { Self::Nothing };
        }
        let first = number("BENCHDOG_FUZZ_SEED").unwrap_or(1_000_000);
        number("BENCHDOG_FUZZ_SECONDS")
            .map_or(Self::Short, |seconds| Self::For { time: Duration::from_secs(seconds), first })
    }
}

/// Prints no panic that becomes an error of the file, as the program does not.
fn leave_damage_to_decoders() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !is_decoding() {
                print(panic);
            }
        }));
    });
}

/// Runs the corpus of a target, then its cases.
#[track_caller]
pub fn check(target: &Target) {
    leave_damage_to_decoders();
    let wanted = Wanted::of(target.name);
    let corpus = corpus(target.name);
    let bases: Vec<&Files> = target.valid.iter().chain(corpus.iter().map(|(_, files)| files)).collect();
    let mutator = Mutator::of(&bases);
    let runner = Runner::begin(target, matches!(wanted, Wanted::Again { .. }));
    let mut failures: Vec<String> = Vec::new();
    let case = |seed: u64| runner.run(&seed.to_string(), &mutated(target, &bases, &mutator, seed));
    let (start, mut count) = (Instant::now(), 0);
    if matches!(wanted, Wanted::Short | Wanted::For { .. }) {
        let whole = target.valid.iter().enumerate().map(|(number, files)| (format!("valid-{number}"), files));
        let all = whole.chain(corpus.iter().map(|(name, files)| (name.clone(), files)));
        failures.extend(all.filter_map(|(name, files)| runner.run(&name, files).err()));
    }
    let seeds = match wanted {
        Wanted::Short => 0..target.cases,
        Wanted::For { first, .. } => first..u64::MAX,
        Wanted::Again { seed } => seed..seed + 1,
        Wanted::Nothing => 0..0,
    };
    for seed in seeds {
        let is_over = matches!(wanted, Wanted::For { time, .. } if start.elapsed() > time);
        if is_over || failures.len() >= MOST_FAILURES {
            break;
        }
        failures.extend(case(seed).err());
        count += 1;
    }
    let (name, seconds) = (target.name, start.elapsed().as_secs_f64());
    println!("{name}: {count} cases and {} of the corpus in {seconds:.1} s, {} failed", corpus.len(), failures.len());
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

/// The files that are kept for a target: each folder is a case that once failed.
fn corpus(target: &str) -> Vec<(String, Files)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(target);
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let mut paths: Vec<_> = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        paths
    };
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let file = |path: &PathBuf| (name(path), fs::read(path).unwrap());
    entries(&folder).iter().map(|case| (name(case), entries(case).iter().map(file).collect())).collect()
}

/// The case of a seed.
fn mutated(target: &Target, bases: &[&Files], mutator: &Mutator, seed: u64) -> Files {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut files = bases[rng.random_range(0..bases.len())].clone();
    for _ in 0..rng.random_range(1..=MOST_MUTATIONS) {
        let place = rng.random_range(0..files.len());
        let bytes = &mut files[place].1;
        if !(target.mutate)(bytes, &mut rng) {
            mutator.mutate(bytes, &mut rng);
        }
    }
    files
}

/// Runs cases in folders of their own, and watches their time.
struct Runner<'a> {
    target: &'a Target,
    folder: PathBuf,
    keeps: bool,
    /// The case that runs now.
    current: Arc<Mutex<Option<(Instant, String)>>>,
}

impl<'a> Runner<'a> {
    fn begin(target: &'a Target, keeps: bool) -> Self {
        let current: Arc<Mutex<Option<(Instant, String)>>> = Arc::default();
        let (watched, name) = (Arc::downgrade(&current), target.name);
        thread::spawn(move || {
            while let Some(current) = watched.upgrade() {
                if let Some((_, case)) = current.lock().unwrap().as_ref().filter(|(start, _)| start.elapsed() > LONGEST)
                {
                    eprintln!("{name}: the case {case} takes longer than {} s", LONGEST.as_secs());
                    process::exit(1);
                }
                drop(current);
                thread::sleep(Duration::from_millis(200));
            }
        });
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz").join(target.name);
        let _ = fs::remove_dir_all(&folder);
        Self { target, folder, keeps, current }
    }

    /// Runs a case. Its files stay if it fails, or ends the process.
    fn run(&self, name: &str, files: &Files) -> Result<(), String> {
        let folder = self.folder.join(name);
        fs::create_dir_all(&folder).unwrap();
        for (file, bytes) in files {
            fs::write(folder.join(file), bytes).unwrap();
        }
        let replay = format!("BENCHDOG_FUZZ={}:{name}", self.target.name);
        *self.current.lock().unwrap() = Some((Instant::now(), format!("{} ({replay})", folder.display())));
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.target.run)(&folder, &files[0].0)));
        *self.current.lock().unwrap() = None;
        let outcome = outcome.unwrap_or_else(|panic| Err(format!("panic: {}", text_of(&*panic))));
        if outcome.is_ok() && !self.keeps {
            fs::remove_dir_all(&folder).unwrap();
        }
        outcome.map_err(|problem| format!("{replay}: {problem}; its files are in {}", folder.display()))
    }
}

fn text_of(panic: &(dyn Any + Send)) -> &str {
    panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("")
}
