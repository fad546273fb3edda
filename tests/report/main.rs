//! The page of a result: what it says is what the files say; it needs no network, and works in a real browser.

mod browser;
mod in_browser;
mod paper_page;
mod results;
#[path = "../live/support.rs"]
#[allow(dead_code)]
mod support;

use std::fs;
use std::path::Path;

use results::{
    Cells, HOSTILE, city, copied, failed_report, plain, replaced, report, report_of, rounded, shown, study,
    with_vehicles,
};
use support::{NEW, Running, json, number, run_command, table};

#[test]
fn the_numbers_of_the_page_are_those_of_the_files() {
    let run = city();
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    let summary = json(&run.join("summary.json"));
    let fleet = Cells::of(&page, "fleet");
    for (place, quantity) in ["mean", "p05", "p50", "p95", "max"].iter().enumerate() {
        let wanted = summary["fleet"]["error_rms"][quantity].as_f64().unwrap();
        assert!(
            shown(&fleet.row("error_rms")[2 + place], wanted),
            "{quantity}: {wanted}, {:?}",
            fleet.row("error_rms")
        );
    }
    assert_eq!(fleet.rows.len(), summary["fleet"].as_object().unwrap().len(), "a row for every column of the summary");
    let counts = Cells::of(&page, "counts");
    assert_eq!(counts.row("SUMO: inserted")[1], summary["sumo"]["inserted"].to_string());

    // Without the script, the table has the vehicles with the largest errors.
    let mut rows = table(&run.join("vehicles.csv"));
    rows.sort_by(|a, b| number(b, "error_rms").total_cmp(&number(a, "error_rms")));
    let quality = table(&run.join("quality.csv")).into_iter().map(|row| (row["id"].clone(), row));
    let quality: std::collections::BTreeMap<String, support::Row> = quality.collect();
    let vehicles = Cells::of(&page, "vehicles-table");
    assert!(vehicles.head.iter().any(|header| header == "energy_per_km [Wh/km]"), "{:?}", vehicles.head);
    assert_eq!(vehicles.rows.len(), 50);
    for (row, cells) in rows.iter().zip(&vehicles.rows) {
        for (header, cell) in vehicles.head.iter().zip(cells) {
            let column = header.split(" [").next().unwrap();
            let wanted = row.get(column).unwrap_or_else(|| &quality[&row["id"]][column]);
            let same = wanted.parse().map_or_else(|_| *wanted == *cell, |wanted| shown(cell, wanted));
            assert!(same || wanted.is_empty() && cell == "–", "{column}: {wanted}, shown as {cell}");
        }
    }
}

#[test]
fn the_page_is_one_file_that_asks_nobody() {
    let page = fs::read_to_string(city().join("report.html")).unwrap();
    let load = regex::Regex::new(r#"(?i)(src|srcset|data|action|poster)\s*=\s*["']?(https?:)?//|url\(\s*["']?(https?:)?//|@import|<link[^>]+href="(?:[^d]|d[^a])"#).unwrap();
    assert_eq!(load.find(&page).map(|found| found.as_str()), None);
    assert!(page.contains("default-src 'none'"), "a browser is told so, too");
    assert!(page.contains("Permission is hereby granted"), "the licence of the chart library comes with it");
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
}

#[test]
fn the_head_says_how_to_do_it_again() {
    let run = city();
    let page = plain(&fs::read_to_string(run.join("report.html")).unwrap());
    let manifest = json(&run.join("run.json"));
    assert!(page.contains(&format!("sumo-mfc run --from {}", run.join("run.json").display())), "the command");
    for input in manifest["inputs"].as_array().unwrap() {
        assert!(page.contains(input["sha256"].as_str().unwrap()), "{input}");
    }
    for wanted in ["SUMO 1.28.0", env!("CARGO_PKG_VERSION"), &manifest["seed"].to_string(), "collisions are contacts"] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn every_figure_is_a_file_too() {
    let run = city();
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    let figures = regex::Regex::new(r#"<figure id="figure-([^"]+)""#).unwrap();
    let names: Vec<&str> = figures.captures_iter(&page).map(|found| found.get(1).unwrap().as_str()).collect();
    for wanted in ["distribution_error_rms", "quantiles", "map_error_rms", "time_space"] {
        assert!(names.contains(&wanted), "{wanted} is not among {names:?}");
    }
    for name in &names {
        let svg = fs::read_to_string(run.join("report").join(format!("{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.contains("prefers-color-scheme:dark"), "{name}");
    }
    assert_eq!(fs::read_dir(run.join("report")).unwrap().count(), names.len());
    // Every road on which egos were seen has its colour and its name.
    let map = fs::read_to_string(run.join("report/map_error_rms.svg")).unwrap();
    let edges = table(&run.join("edges.csv"));
    assert_eq!(map.matches("class=\"road\"").count(), edges.len());
    assert!(edges.iter().all(|edge| map.contains(&format!("<title>{}: ", edge["edge"]))));
}

#[test]
fn conflicts_stand_on_the_map_once_at_their_places() {
    let run = city();
    let log = fs::read_to_string(run.join("sumo/ssm.xml")).unwrap();
    let conflict = regex::Regex::new(r#"(?s)<conflict [^>]*ego="([^"]+)" foe="([^"]+)">(.*?)</conflict>"#).unwrap();
    let measure = regex::Regex::new(r#"time="([0-9.]+)" position="([0-9.,-]+)""#).unwrap();
    let pairs: std::collections::BTreeSet<[String; 4]> = conflict
        .captures_iter(&log)
        .map(|found| {
            let (ego, foe) = (found[1].to_owned(), found[2].to_owned());
            let first = measure.captures(&found[3]).expect("a measure with a value");
            [ego.clone().min(foe.clone()), ego.max(foe), first[1].to_owned(), first[2].to_owned()]
        })
        .collect();
    assert!(pairs.len() > 5, "the city has conflicts: {}", pairs.len());
    let map = fs::read_to_string(run.join("report/map_error_rms.svg")).unwrap();
    assert_eq!(map.matches("class=\"conflict\"").count(), pairs.len());
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    let table = Cells::of(&page, "safety-conflicts");
    assert_eq!(table.rows.len(), pairs.len().min(50));
    assert!(page.contains(&format!("Rings: {} conflicts", pairs.len())), "the caption says what the rings are");
    let column = |name: &str| table.head.iter().position(|head| head.starts_with(name)).unwrap();
    let times =
        |row: &Vec<String>| [column("TTC"), column("PET")].map(|c| row[c].parse::<f64>().unwrap_or(f64::INFINITY));
    let shortest: Vec<f64> =
        table.rows.iter().map(|row| times(row).into_iter().fold(f64::INFINITY, f64::min)).collect();
    assert!(shortest.is_sorted(), "the severest first: {shortest:?}");
}

#[test]
fn warnings_of_sumo_stand_on_the_map_one_dot_a_road() {
    let dir = copied(city());
    let edges = table(&dir.path().join("edges.csv"));
    let lanes = [0, 1].map(|k| format!("{}_0", edges[k]["edge"]));
    let log = format!(
        "Warning: Vehicle 'a'; collision with vehicle 'b', lane='{0}', gap=-0.50, time=35.00, stage=move.\n\
         Warning: Vehicle 'c' performs emergency braking on lane '{0}' with decel=9.00, wished=4.50, severity=1.00, time=36.00.\n\
         Warning: Vehicle 'd'; collision with vehicle 'e', lane='{1}', gap=-0.10, time=37.00, stage=move.\n\
         Warning: Vehicle 'f'; collision with vehicle 'g', lane='nowhere_0', gap=-0.10, time=38.00, stage=move.\n",
        lanes[0], lanes[1]
    );
    fs::write(dir.path().join("sumo/sumo.log"), log).unwrap();
    report(&[dir.path()], &[]);
    let map = fs::read_to_string(dir.path().join("report/map_error_rms.svg")).unwrap();
    assert_eq!(map.matches("class=\"event\"").count(), 2);
    assert!(map.contains(&format!("<title>{}: 1 x collision, 1 x emergency braking</title>", edges[0]["edge"])));
    assert!(map.contains("<title>Vehicle &#39;d&#39;; collision") || map.contains("<title>Vehicle 'd'; collision"));
    let page = plain(&fs::read_to_string(dir.path().join("report.html")).unwrap());
    assert!(page.contains("Dots: 3 safety events of SUMO's log on 2 roads, in the middle of each."));
}

#[test]
fn hostile_ids_are_text() {
    let dir = copied(city());
    with_vehicles(dir.path(), |rows| {
        for (row, id) in rows.iter_mut().rev().zip(HOSTILE) {
            row[0] = id.to_owned();
            row[1] = id.to_owned();
        }
        // Above all others, so that the part of the table without script has them.
        let errors = 12;
        rows.iter_mut().rev().take(HOSTILE.len()).for_each(|row| row[errors] = "9.5".into());
    });
    report(&[dir.path()], &[]);
    let page = fs::read_to_string(dir.path().join("report.html")).unwrap();
    assert!(page.contains("&lt;script&gt;hacked = 1"), "it is there");
    assert!(
        !page.contains("<script>hacked") && !page.contains("<img") && !page.contains("onerror=\"hacked"),
        "as text"
    );
    let scripts = page.matches("<script").count();
    assert_eq!(scripts, page.matches("</script").count());
    assert_eq!(scripts, fs::read_to_string(city().join("report.html")).unwrap().matches("<script").count());
}

#[test]
fn without_a_report_there_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = support::repository("scenarios/straight.toml");
    let args = ["--no-report", "--end", "20"];
    let ended = Running::start(run_command(NEW, &scenario, folder.path(), &args)).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(folder.path().join("vehicles.csv").is_file());
    assert!(!folder.path().join("report.html").exists() && !folder.path().join("report").exists());
    let ended = Running::start(run_command(NEW, &scenario, folder.path(), &["--force", "--end", "20"])).wait();
    assert!(ended.stdout.contains("report.html"), "{}", ended.stdout);
    assert!(folder.path().join("report.html").is_file());
    // A new result does not keep the old one's page.
    Running::start(run_command(NEW, &scenario, folder.path(), &["--force", "--no-report", "--end", "20"])).wait();
    assert!(!folder.path().join("report.html").exists());
    assert_eq!(fs::read_dir(folder.path().join("report")).unwrap().count(), 0);
}

#[test]
fn what_is_missing_is_said_and_the_rest_is_shown() {
    let dir = copied(city());
    for name in ["edges.csv", "sample.csv", "sumo/sumo.log"] {
        fs::remove_file(dir.path().join(name)).unwrap();
    }
    let gone = dir.path().join("gone.net.xml").display().to_string();
    replaced(&dir.path().join("run.json"), "city.net.xml", &gone);
    report(&[dir.path()], &[]);
    let page = fs::read_to_string(dir.path().join("report.html")).unwrap();
    for wanted in [
        "edges.csv is not in the folder",
        "sample.csv is not in the folder",
        "sumo.log cannot be read",
        "the map is left out",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    assert!(page.contains("figure-distribution_error_rms") && !page.contains("figure-map_"));
    // A run that broke off says so before anything else.
    replaced(&dir.path().join("run.json"), "\"complete\"", "\"incomplete\"");
    replaced(&dir.path().join("run.json"), "\"reason\": null", "\"reason\": \"SUMO died\"");
    fs::remove_file(dir.path().join("vehicles.csv")).unwrap();
    report(&[dir.path()], &[]);
    let page = fs::read_to_string(dir.path().join("report.html")).unwrap();
    assert!(page.contains("The run is not complete: SUMO died"));
    assert!(page.contains("vehicles.csv is not in the folder") && Cells::of(&page, "fleet").rows.len() > 10);
}

#[test]
fn what_cannot_be_shown_is_one_clear_error() {
    let empty = tempfile::tempdir().unwrap();
    let said = failed_report(&[empty.path()], &[]);
    assert!(said.contains("found neither run.json nor study.json"), "{said}");
    let dir = copied(city());
    let said = failed_report(&[dir.path()], &["--vehicle", "nobody-of-that-name"]);
    assert!(said.contains("--vehicle: found nobody-of-that-name, which is in no table"), "{said}");
    let said = failed_report(&[city(), study()], &[]);
    assert!(said.contains("wanted two of a kind"), "{said}");
    let said = failed_report(&[city(), city(), city()], &[]);
    assert!(said.contains("found 3 results"), "{said}");
    with_vehicles(dir.path(), |rows| rows[3][12] = "fast".into());
    let said = failed_report(&[dir.path()], &[]);
    assert!(said.contains("vehicles.csv:5: error_rms: found fast, wanted a number"), "{said}");
}

#[test]
fn a_vehicle_that_is_asked_for_has_its_curves_as_figures() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("one.html");
    let traced = table(&city().join("trace.csv"))[0]["id"].clone();
    report(&[city()], &["--vehicle", &traced, "-o", page.to_str().unwrap()]);
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains(&format!("<h2>Vehicle {traced}</h2>")) && text.contains("figure-vehicle_alpha_hat"));
    assert!(folder.path().join("one/vehicle_measured_speed.svg").is_file(), "figures go beside their page");
    assert!(text.contains(&format!("\"selected\":\"{traced}\"")));
}

#[test]
fn other_formats_of_the_table_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = support::repository("scenarios/straight.toml");
    let mut pages = Vec::new();
    for name in ["v.csv", "v.parquet", "v.xml"] {
        let dir = folder.path().join(name);
        let args = ["--end", "30", "--vehicles-output", name];
        let ended = Running::start(run_command(NEW, &scenario, &dir, &args)).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        pages.push(Cells::of(&fs::read_to_string(dir.join("report.html")).unwrap(), "vehicles-table").rows);
    }
    assert!(!pages[0].is_empty());
    assert_eq!((&pages[1], &pages[2]), (&pages[0], &pages[0]));
}

#[test]
fn two_runs_side_by_side_show_the_differences() {
    let other = copied(city());
    with_vehicles(other.path(), |rows| {
        for row in rows {
            let error: f64 = row[12].parse().unwrap();
            row[12] = (error + 0.25).to_string();
        }
    });
    let page = report_of(&[city(), other.path()]);
    let differences = Cells::of(&page, "differences");
    let place = differences.head.iter().position(|head| head == "same vehicles").unwrap();
    assert!(
        shown(differences.row("error_rms")[place].trim_start_matches('+'), 0.25),
        "{:?}",
        differences.row("error_rms")
    );
    assert_eq!(differences.row("error_rms")[place + 1], table(&city().join("vehicles.csv")).len().to_string());
    assert_eq!(differences.row("timeloss")[place], "0");
    for wanted in [
        "A: adaptive",
        "B: adaptive",
        "figure-map_error_rms_A",
        "figure-map_error_rms_B",
        "figure-difference_error_rms",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn a_study_has_its_table_curves_and_failures() {
    let dir = study();
    let page = fs::read_to_string(dir.join("report.html")).unwrap();
    let rows = table(&dir.join("comparison.csv"));
    let cells = Cells::of(&page, "comparison-error_rms_mean");
    let errors: Vec<_> = rows.iter().filter(|row| row["metric"] == "error_rms_mean").collect();
    assert_eq!(cells.rows.len(), errors.len());
    for (row, cells) in errors.iter().zip(&cells.rows) {
        assert_eq!([&cells[0], &cells[1]], [&row["controller.name"], &row["controller.k_p"]]);
        let (mean, half) = cells[2].split_once(" ± ").unwrap();
        assert!(rounded(mean, number(row, "mean")) && rounded(half, number(row, "ci95")), "{row:?} as {cells:?}");
        if !row["diff"].is_empty() {
            let difference = cells[3].split(" ± ").next().unwrap().trim_start_matches('+');
            assert!(rounded(difference, number(row, "diff")), "{row:?} as {cells:?}");
        }
    }
    for wanted in [
        "figure-curve_error_rms_mean_controller-k_p",
        "figure-intervals_error_rms_mean",
        "figure-heat_error_rms_mean_controller-name_controller-k_p",
        "intervals from fewer than 5 seeds are not to be believed",
        "sumo-mfc run --from",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    // A law is known by its name, a number by its key.
    let figure = |name: &str| fs::read_to_string(dir.join("report").join(format!("{name}.svg"))).unwrap();
    assert!(figure("intervals_error_rms_mean").contains(">adaptive, k_p=0.5"));
    assert!(figure("curve_error_rms_mean_controller-k_p").contains(">adaptive<"));
    assert_eq!(Cells::of(&page, "cases").rows.len(), 12);
    assert!(!Path::new(&dir.join("cases/0001/report.html")).exists(), "a case has no page of its own");

    let broken = copied(dir);
    replaced(&broken.path().join("cases.csv"), ",2,done,", ",2,failed,SUMO <died>");
    report(&[broken.path()], &[]);
    let page = fs::read_to_string(broken.path().join("report.html")).unwrap();
    assert!(page.contains("6 cases failed") && page.contains("SUMO &lt;died&gt;"));
    assert_eq!(Cells::of(&page, "failures").rows.len(), 6);

    let page = report_of(&[dir, dir]);
    let side = Cells::of(&page, "side-error_rms_mean");
    assert_eq!(side.rows.len(), 6);
    assert!(side.rows.iter().all(|row| row[4] == "0" && row[2] == row[3]), "{:?}", side.rows);
}
