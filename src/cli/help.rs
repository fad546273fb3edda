//! The words of `--help` that belong to no single option: groups of options, and examples.

/// The groups of options, in the order in which most subcommands show them.
pub const SCENARIO: &str = "Scenario";
pub const CONTROLLER: &str = "Controller and egos";
pub const SUMO: &str = "SUMO";
pub const STUDY: &str = "Study";
pub const CASES: &str = "Cases, and who runs them";
pub const OUTPUT: &str = "Output";
pub const GENERAL: &str = "General";

/// What examples begin with.
pub const HEAD: &str = "Examples:\n";

/// What stands below the list of subcommands.
pub const MAIN: &str = "\
Examples:
  sumo-mfc doctor                              Is SUMO there, and does it do what we need?
  sumo-mfc run scenarios/demo.toml             One run: results and a page
  sumo-mfc compare city.sumocfg --seeds 1..10  Four controllers on the same traffic, one table
  sumo-mfc paper                               The experiments of the paper, without SUMO

`sumo-mfc help COMMAND` says more about each.";

/// Examples of `run`.
pub const RUN: &str = "\
Examples:
  sumo-mfc run city.sumocfg                    Any configuration: all cars get a body and a law
  sumo-mfc run scenarios/demo.toml --controller pid --seed 7 --trace all -o out/pid
  sumo-mfc run --net a.net.xml --routes a.rou.xml --egos share:0.25 --set noise.power_db=-6
  sumo-mfc run city.sumocfg -- --scale 1.5     What follows -- goes to SUMO

Exit codes: 0 done, 1 any error, 130 SIGINT, 143 SIGTERM, 129 SIGHUP.";

/// Examples of `compare`.
pub const COMPARE: &str = "\
Examples:
  sumo-mfc compare scenarios/demo.toml         Four controllers, seeds 1 to 5, on all cores
  sumo-mfc compare city.sumocfg --controllers plain,adaptive,pid --seeds 1..20 -o out/city
  sumo-mfc compare scenarios/demo.toml --status  How far are the cases?
  sumo-mfc compare scenarios/demo.toml --collect --export md  (the table, for a README)

The first controller is the reference; `plain` is SUMO without us. The same command goes on where
it was interrupted.";

/// Examples of `sweep`.
pub const SWEEP: &str = "\
Examples:
  sumo-mfc sweep scenarios/studies/dead_time.toml  A study: scenario, keys and seeds in one file
  sumo-mfc sweep city.sumocfg --vary actuator.delay_s=0..0.4..0.1 --seeds 1..10 --plan
  sumo-mfc sweep scenarios/demo.toml --vary egos.select=share:0.5,all --reference egos.select=all
  sumo-mfc sweep scenarios/studies/mass.toml --executor slurm --slurm partition=short

The same command goes on where it was interrupted: finished cases are never run again.";

/// Examples of `recover`.
pub const RECOVER: &str = "\
Examples:
  sumo-mfc recover out/city-adaptive-42        The run was killed: what it wrote becomes tables

Rows are those of vehicles that had left. The result stays marked incomplete.";

/// Examples of `report`.
pub const REPORT: &str = "\
Examples:
  sumo-mfc report out/demo-adaptive-42         Writes report.html into that folder
  sumo-mfc report out/pid --vehicle veh12 -o veh12.html
  sumo-mfc report out/pid out/adaptive -o both.html";

/// Examples of `check`.
pub const CHECK: &str = "\
Examples:
  sumo-mfc check scenarios/demo.toml           Is it right, and what exactly will run?
  sumo-mfc check --template                    Every key with its unit, range and default
  sumo-mfc check --schema                      For editors that complete TOML
  sumo-mfc check city.sumocfg --controller pid  A scenario file to begin with";

/// Examples of `paper`.
pub const PAPER: &str = "\
Examples:
  sumo-mfc paper                               All tests, all presets: figures and a page
  sumo-mfc paper step --preset default --export csv
  sumo-mfc paper driver --driver lap.csv --set controller.k_p=1.2 -o out/lap
  sumo-mfc paper record --seed 2 -o out/lap    A lap as a human drives it, to give to --driver
  sumo-mfc paper map --coarse                  Where adaptation helps, on a coarse grid";

/// Examples of `tune`.
pub const TUNE: &str = "\
Examples:
  sumo-mfc tune --train scenarios/paper/data/udds.csv --test scenarios/paper/data/hwfet.csv
  sumo-mfc tune scenarios/demo.toml --gains 1 --train udds.csv --test hwfet.csv --export md
  sumo-mfc tune --train a.csv --test b.csv --condition ok: --condition late:actuator.delay_s=0.25

Every law has as many free gains, the same recordings and the same number of trials.";

/// Examples of `stability`.
pub const STABILITY: &str = "\
Examples:
  sumo-mfc stability                           All laws: margins, and strings of ten followers
  sumo-mfc stability --controllers classic,mpc --lag 0.2 --delay 0,0.1,0.2 --export md
  sumo-mfc stability --controllers pid --set controller.k_p=2 --uppers path_cacc -o out/pid";

/// Examples of `list`.
pub const LIST: &str = "\
Examples:
  sumo-mfc list                                kind, name and summary, tabs between them
  sumo-mfc list --export md                    The same as a table";

/// Examples of `doctor`.
pub const DOCTOR: &str = "\
Examples:
  sumo-mfc doctor                              Of the SUMO that a run would use";

/// Examples of `completions`.
pub const COMPLETIONS: &str = "\
Examples:
  source <(sumo-mfc completions bash)          For this shell
  sumo-mfc completions bash > ~/.local/share/bash-completion/completions/sumo-mfc
  sumo-mfc completions fish > ~/.config/fish/completions/sumo-mfc.fish
  sumo-mfc completions zsh > _sumo-mfc         To be moved into a folder of $fpath";

/// Examples of `man`.
pub const MAN: &str = "\
Examples:
  sumo-mfc man | man -l -                      The page of the program
  sumo-mfc man -o ~/.local/share/man/man1      For man sumo-mfc, man sumo-mfc-run, ...";
