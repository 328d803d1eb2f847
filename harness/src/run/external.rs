//! A method runs on a problem: one of ours in its loop; another code as a program, once at each of its tolerances, its
//! impulses measured as ours are.

use crate::plan::{Method, Programme, Runs, last_line};
use crate::problems::Problem;
use crate::terminal::{exit, read_text};
use anyhow::{Context, Result, anyhow, bail};
use contact::{Measure, Measures, Work};
use lineup::{Observe, OneProblem, Run};
use results::schema::Sample;
use runner::{Outcome, Progress, Status};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::path::Path;
use std::process::{Child, ExitStatus};
use std::time::{Duration, Instant};

/// Outcome of a method, ours or another code's.
pub(crate) struct Ended {
    pub(crate) outcome: Outcome,
    /// Runs of another code, one at each tolerance; of ours none.
    pub(crate) rungs: Vec<Rung>,
    /// The curve of another code: r = 0, then a sample for each tolerance.
    pub(crate) samples: Vec<Sample>,
    /// Reason why another code gave no answer at a tolerance, where it gave none; the outcome is the one before.
    pub(crate) failed: Option<String>,
}

/// One run of another code.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Rung {
    /// Tolerance that the code was asked for.
    tolerance: f64,
    /// Its own count.
    iterations: u64,
    /// Time by the code's own clock, from the numbers of the file to what its solver takes (s).
    setup_s: f64,
    /// Time by the code's own clock, in its solver (s).
    solve_s: f64,
    /// Time by our clock, of its whole process, with what starts it and what it reads and writes (s).
    process_s: f64,
    /// Status in the code's own words.
    ending: String,
    natural_map: f64,
    #[serde(with = "contact::number")]
    velocity_error: f64,
}

/// Answer that a driver writes.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    /// Impulses in the problem's contact order, a flat list (N·s).
    impulse: Vec<Option<f64>>,
    iterations: u64,
    setup_s: f64,
    solve_s: f64,
    ending: String,
}

/// Runs `method` under the conditions of `run`. Of ours, the iterates that these name are measured; of another code every answer.
///
/// # Errors
/// Says why the method cannot start on the problem.
pub(crate) fn ended(method: &Method, problem: &Problem, run: Run, observe: &mut Observe) -> Result<Ended> {
    match &method.runs {
        Runs::Here(ours) => {
            let outcome = problem.posed.solve(ours, run, observe)?;
            Ok(Ended { outcome, rungs: Vec::new(), samples: Vec::new(), failed: None })
        }
        Runs::Elsewhere(programme) => {
            let problem = problem.posed.grains()?;
            may_start(programme, problem, run)?;
            Ladder { programme, problem, run }.climb(observe)
        }
    }
}

/// Refuses what another code cannot do.
fn may_start(programme: &Programme, problem: &dyn OneProblem, run: Run) -> Result<()> {
    let Run { truths, r0, stop, .. } = run;
    let (code, facts) = (programme.code, problem.facts());
    if !code.can(facts.mechanics) {
        bail!("{} does not solve problems of {}", code.name, facts.in_words());
    }
    if let Err(why) = code.version() {
        bail!("{} is not installed ({why}); `{}` installs it", code.name, code.install());
    }
    if r0.iter().any(|r| *r != 0.0) {
        bail!(
            "{} begins from r = 0: no impulses of a time step before are handed to another code",
            code.name
        );
    }
    stop.check()?;
    match stop.on {
        Measure::NaturalMap => Ok(()),
        Measure::VelocityError if !truths.is_empty() => Ok(()),
        Measure::VelocityError => {
            bail!("`on` is {}: the true velocity of this problem is not known", stop.on)
        }
        // The others compare iterates, which another code keeps to itself, or can be met far from a solution.
        other => bail!("`on` is {other}: another code stops on natural_map or velocity_error"),
    }
}

/// Another code on a problem, at one tolerance after the other.
struct Ladder<'l> {
    programme: &'l Programme,
    problem: &'l dyn OneProblem,
    run: Run<'l>,
}

impl Ladder<'_> {
    /// Asks for ever less, until what is measured meets the stop rule.
    fn climb(&self, observe: &mut Observe) -> Result<Ended> {
        let folder = tempfile::tempdir().context("a folder for the other code")?;
        let problem = folder.path().join("problem.json");
        std::fs::write(&problem, self.problem.to_json()?).with_context(|| problem.display().to_string())?;
        let mut ended = self.begun(vec![0.0; self.run.r0.len()]);
        let trivial = self.problem.scale() == 0.0;
        let mut status = self.judge(&mut ended, trivial, observe);
        for &tolerance in &self.programme.tolerances {
            if status.is_some() {
                break;
            }
            match self.rung(tolerance, folder.path()) {
                Ok(None) => status = Some(Status::Interrupted),
                Ok(Some((answer, process_s))) => {
                    self.take(&mut ended, answer, tolerance, process_s);
                    status = self.judge(&mut ended, false, observe);
                }
                Err(why) => {
                    ended.failed = Some(format!("at the tolerance {tolerance:e}: {why:#}"));
                    break;
                }
            }
        }
        // No other tolerance is left that might bring it nearer.
        ended.outcome.status = status.unwrap_or(Status::Stalled);
        Ok(ended)
    }

    /// Returns the state before any run, at the impulses `r`.
    fn begun(&self, r: Vec<f64>) -> Ended {
        let outcome = Outcome {
            status: Status::Stalled,
            iterations: 0,
            measures: self.problem.measures(self.run.truths, &r),
            impulses: r,
            setup: Duration::ZERO,
            iterating: Duration::ZERO,
            work: Work::default(),
            derived: Vec::new(),
            critical_path: None,
            last_change_moves: f64::NAN,
            cycle: None,
        };
        Ended { outcome, rungs: Vec::new(), samples: Vec::new(), failed: None }
    }

    /// Takes an answer that was checked.
    fn take(&self, ended: &mut Ended, answer: Answer, tolerance: f64, process_s: f64) {
        let Answer { impulse, iterations, setup_s, solve_s, ending } = answer;
        let r: Vec<f64> = impulse.into_iter().flatten().collect();
        // By themselves: one run is no step from another.
        let measures = self.problem.measures(self.run.truths, &r);
        let Measures { natural_map, velocity_error, .. } = measures;
        let outcome = &mut ended.outcome;
        (outcome.iterations, outcome.measures, outcome.impulses) = (iterations, measures, r);
        [outcome.setup, outcome.iterating] = [setup_s, solve_s].map(Duration::from_secs_f64);
        outcome.derived = vec![("tolerance", tolerance), ("process_s", process_s)];
        ended.rungs.push(Rung {
            tolerance,
            iterations,
            setup_s,
            solve_s,
            process_s,
            ending,
            natural_map,
            velocity_error,
        });
    }

    /// Shows the iterate and keeps it as a sample; says how the run has ended, if it has.
    fn judge(&self, ended: &mut Ended, trivial: bool, observe: &mut Observe) -> Option<Status> {
        let Outcome { iterations, iterating, ref measures, ref impulses, .. } = ended.outcome;
        let work = Work::default();
        let iterating_s = iterating.as_secs_f64();
        ended.samples.push(Sample { iteration: iterations, iterating_s, measures: *measures, work });
        let goes_on =
            observe(&Progress { iteration: iterations, iterating, measures: Some(measures), work, impulses });
        if trivial || measures.get(self.run.stop.on) <= self.run.stop.tolerance {
            Some(Status::Converged)
        } else {
            goes_on.is_break().then_some(Status::Interrupted)
        }
    }

    /// One run of the program: its answer and the time of its process (s); `None` if the user stopped it.
    fn rung(&self, tolerance: f64, folder: &Path) -> Result<Option<(Answer, f64)>> {
        let (problem, answer) = (folder.join("problem.json"), folder.join("answer.json"));
        // What an earlier run left is no answer of this one.
        if answer.exists() {
            std::fs::remove_file(&answer)?;
        }
        let complaints = folder.join("complaints");
        let mut command = self.programme.command(&problem, &answer, tolerance, self.run.stop.max_iterations);
        command.stdout(File::create(folder.join("chatter"))?).stderr(File::create(&complaints)?);
        // Ctrl-C is for this program, which ends the other one.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let clock = Instant::now();
        let child = command.spawn().with_context(|| command.get_program().to_string_lossy().into_owned())?;
        let Some(status) = wait(child, self.programme.time_out)? else { return Ok(None) };
        let process_s = clock.elapsed().as_secs_f64();
        if !status.success() {
            let said = std::fs::read(&complaints)?;
            bail!("it ended with {status}: {}", last_line(&String::from_utf8_lossy(&said)));
        }
        let text = read_text(&answer).context("it wrote no answer")?;
        let answer: Answer = serde_json::from_str(&text).map_err(|error| anyhow!("its answer: {error}"))?;
        answer.check(self.problem)?;
        Ok(Some((answer, process_s)))
    }
}

impl Answer {
    /// Refuses what is no answer to the problem.
    fn check(&self, problem: &dyn OneProblem) -> Result<()> {
        let (each, contacts) = (problem.facts().of_contact, problem.facts().contacts);
        let found = self.impulse.len();
        if found != each * contacts {
            let of = if each == 1 { String::new() } else { format!(" of {each} numbers each") };
            bail!("it answers {found} impulses where the problem has {contacts} contacts{of}");
        }
        for (contact, r) in self.impulse.chunks_exact(each).enumerate() {
            let Some(r) = r.iter().copied().collect::<Option<Vec<f64>>>() else {
                bail!("the impulse of contact {contact} is missing");
            };
            if let Err(why) = problem.unless_admissible(contact, &r) {
                bail!("the impulse of contact {contact} {why}");
            }
        }
        let seconds = [self.setup_s, self.solve_s];
        if seconds.into_iter().any(|s| Duration::try_from_secs_f64(s).is_err()) {
            bail!("its clock says {} s and {} s", self.setup_s, self.solve_s);
        }
        Ok(())
    }
}

/// Waits for a program until it is to be given up; `None` if the user stopped it.
fn wait(mut child: Child, time_out: Duration) -> Result<Option<ExitStatus>> {
    /// Interval between two checks, and so the resolution of the time of a process.
    const LOOK: Duration = Duration::from_millis(1);
    let clock = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        let (stopped, late) = (exit::requested(), clock.elapsed() > time_out);
        if stopped || late {
            child.kill()?;
            child.wait()?;
        }
        if stopped {
            return Ok(None);
        }
        if late {
            bail!("no answer within {} s", time_out.as_secs_f64());
        }
        std::thread::sleep(LOOK);
    }
}
