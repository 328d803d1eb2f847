//! The collection: ids by content, statuses that are recomputed, submissions judged from their impulses alone.

use crate::bench::Study;
use crate::common::{checkout, entries, gravel, pair_with, text, write};
use seal::sealed;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A checkout with the pair in its collection, and the id of the pair.
fn with_pair() -> (Study, String) {
    let study = Study::new();
    let pair = study.folder().path().join("cases/frozen/pair.json");
    study.gravel(&["collection", "add", text(&pair)]).succeeded();
    let id = ids(&study).remove(0);
    (study, id)
}

fn ids(study: &Study) -> Vec<String> {
    let listed = study.gravel(&["collection", "list", "--ids"]).succeeded().stdout;
    listed.lines().map(str::to_owned).collect()
}

fn file(study: &Study, name: &str) -> PathBuf {
    study.folder().path().join("cases/collection").join(name)
}

/// Replaces a text in a file of the collection.
fn change(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "no {from} in {text}");
    fs::write(file, text.replace(from, to)).unwrap();
}

/// A submission of impulses for a problem, as a code writes it that knows nothing of gravel.
fn submission(problem: &str, impulse: &Value) -> Value {
    json!({
        "format": "gravel/submission/1", "problem": problem, "code": "mine", "version": "0.1", "impulse": impulse
    })
}

/// Makes of the pair a problem that is open, with half of its impulses as the best.
fn opened(study: &Study, id: &str) {
    fs::write(file(study, &format!("answers/{id}.json.gz")), sealed("{\"best\":[0.075,0.05]}")).unwrap();
    let entry = file(study, &format!("entries/{id}.toml"));
    change(&entry, "status = \"certified\"\nsolutions = 1", "status = \"open\"\nsolutions = 0");
    let known = fs::read_to_string(&entry).unwrap();
    let (before, _) = known.split_once("natural_map").unwrap();
    fs::write(&entry, format!("{before}natural_map = 0.5\n")).unwrap();
    study.gravel(&["collection", "check"]).succeeded();
}

/// A plan takes problems of the collection by their names.
#[test]
fn plan_takes_what_is_collected_by_pattern() {
    let (study, _) = with_pair();
    let of = |pattern: &str| {
        let methods = "[[methods]]\nmethod = \"nsgs\"\n";
        let text = crate::bench::plan("collected", &[], methods)
            .replace("problems = []", &format!("collected = [{pattern:?}]"));
        write(study.folder(), "harness/plans/collected.toml", &text);
    };
    of("pai*");
    let rows = crate::bench::rows(study.bench("collected").join("runs.csv"));
    assert_eq!(rows.iter().map(|row| row["problem"].as_str()).collect::<Vec<_>>(), ["pair"]);
    assert!(rows[0]["problem_settings"].contains("\"known\":\"certified\""), "{rows:?}");
    of("pear*");
    let words = ["collected.toml", "no stored problem of the collection matches `pear*`"];
    study.gravel(&["bench", "collected"]).refused(&words);
}

#[test]
fn id_is_that_of_the_content_and_not_of_the_file() {
    let (study, id) = with_pair();
    let in_other_words = serde_json::to_string_pretty(&pair_with("/name", "another name".into())).unwrap();
    let same = write(study.folder(), "same.json", &in_other_words);
    study.gravel(&["collection", "add", text(&same)]).refused(&["in the collection already", &id]);
    let heavier =
        write(study.folder(), "heavier.json", &pair_with("/grains/mass", json!([1.0, 2.5])).to_string());
    study.gravel(&["collection", "add", text(&heavier)]).succeeded();
    assert_eq!(ids(&study).len(), 2);
    // The hash by which rows of studies know it.
    let solved = study.gravel(&["solve", "pair", "--json"]).json();
    assert_eq!(solved["problem_hash"], json!(id));
    // By its id, a problem is one of the checkout.
    let other = ids(&study).into_iter().find(|other| *other != id).unwrap();
    assert_eq!(study.gravel(&["solve", &other, "--json"]).json()["problem_hash"], json!(other));
}

#[test]
fn truth_of_a_collected_problem_is_that_of_the_collection() {
    let (study, id) = with_pair();
    let references = study.folder().path().join("results/references");
    fs::remove_dir_all(&references).ok();
    let solved = study.gravel(&["solve", "pair", "--method", "cg", "--truth", "--json"]).json();
    assert!(solved["velocity_error"].as_f64() <= Some(1e-6), "{solved}");
    assert!(!references.exists(), "nothing is computed that the collection has");
    // What the problem does not confirm is refused.
    fs::write(file(&study, &format!("answers/{id}.json.gz")), sealed("{\"solutions\":[[0.15,0.2]]}"))
        .unwrap();
    study.gravel(&["solve", "pair", "--truth"]).refused(&[&id, "not certified"]);
    opened(&study, &id);
    let solved = study.gravel(&["solve", "pair", "--method", "cg", "--truth", "--json"]).json();
    assert!(solved["velocity_error"].as_f64() <= Some(1e-6), "an open problem has its reference: {solved}");
}

#[test]
fn two_that_accept_at_once_wait_for_each_other_and_lose_nothing() {
    let (study, id) = with_pair();
    opened(&study, &id);
    let files: Vec<PathBuf> = [0.13, 0.14]
        .map(|r| {
            let held = submission(&id, &json!([r, 0.09]));
            write(study.folder(), &format!("{r}.json"), &held.to_string())
        })
        .into();
    let collection = file(&study, "");
    let held = fs::File::open(&collection).unwrap();
    held.lock().unwrap();
    let mut both: Vec<_> = files
        .iter()
        .map(|file| {
            let args = ["--root", text(study.folder().path()), "accept", text(file)];
            crate::common::command(&args).stdout(std::process::Stdio::null()).spawn().unwrap()
        })
        .collect();
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(both.iter_mut().all(|one| one.try_wait().unwrap().is_none()), "both wait for the lock");
    assert!(!collection.join("submissions").exists());
    drop(held);
    assert!(both.iter_mut().all(|one| one.wait().unwrap().success()));
    assert_eq!(entries(&collection.join("submissions")).len(), 2);
    study.gravel(&["collection", "check"]).succeeded();
}

#[test]
fn recipe_freezes_one_march_at_several_time_steps_and_makes_what_is_missing() {
    let study = Study::new();
    let recipe = "why = \"A test.\"\nlicence = \"CC0-1.0\"\n[[cases]]\ncase = \"column\"\naxes = { time_step = [3, 1], \"sample.grains\" = [4] }\n";
    let recipe = write(study.folder(), "recipe.toml", recipe);
    study.gravel(&["collection", "make", text(&recipe)]).succeeded();
    let listed = study.gravel(&["collection", "list", "--only", "status=certified"]).succeeded().stdout;
    assert!(
        listed.ends_with("2 problems: 2 certified, 0 several, 0 solved, 0 open, 0 no-solution\n"),
        "{listed}"
    );
    for time_step in ["1", "3"] {
        let frozen = study.folder().path().join("frozen.json.gz");
        let freeze =
            ["freeze", "column", "--scene", "sample.grains=4", "--time-step", time_step, "--force", "-o"];
        study.gravel(&[&freeze[..], &[text(&frozen)]].concat()).succeeded();
        assert!(fs::read(&frozen).unwrap().starts_with(&[0x1f, 0x8b]), "a name in .gz is compressed");
        let hash = study.gravel(&["solve", text(&frozen), "--json"]).json()["problem_hash"].clone();
        assert!(ids(&study).contains(&hash.as_str().unwrap().to_owned()), "time step {time_step}");
    }
    let again = study.gravel(&["collection", "make", text(&recipe)]).succeeded().stdout;
    assert_eq!(again, "0 problems made, 2 were there\n");
}

#[test]
fn problem_that_is_not_stored_is_made_from_its_entry_and_checked_by_its_hash() {
    let study = Study::new();
    let recipe = "why = \"A test.\"\nlicence = \"CC0-1.0\"\nstored = false\n[[cases]]\ncase = \"column\"\ntime_step = 2\n";
    let recipe = write(study.folder(), "recipe.toml", recipe);
    study.gravel(&["collection", "make", text(&recipe)]).succeeded();
    let id = ids(&study).remove(0);
    assert!(!file(&study, "problems").exists());
    fs::remove_dir_all(study.folder().path().join("results")).unwrap();
    let checked = study.gravel(&["collection", "check"]).succeeded().stdout;
    assert!(checked.contains("1 problems, of which 1 are not stored and were not made"), "{checked}");
    study.gravel(&["collection", "make", &id]).succeeded();
    let checked = study.gravel(&["collection", "check"]).succeeded().stdout;
    assert_eq!(checked, "1 problems, 0 submissions: 0 faults\n");
    // A recipe that makes another problem is told.
    fs::remove_dir_all(study.folder().path().join("results")).unwrap();
    change(&file(&study, &format!("entries/{id}.toml")), "time_step = 2", "time_step = 3");
    study.gravel(&["collection", "make", &id]).refused(&[&id, "makes a problem with the hash"]);
}

#[test]
fn statuses_are_recomputed_and_nothing_false_passes_the_check() {
    let (study, id) = with_pair();
    let check = |word: &str| {
        let ran = study.gravel(&["collection", "check"]).failed().stdout;
        assert!(ran.contains(word) && ran.contains(": 1 faults"), "no {word}: {ran}");
    };
    let entry = file(&study, &format!("entries/{id}.toml"));
    let whole = fs::read_to_string(&entry).unwrap();
    for (from, to, word) in [
        ("\"certified\"", "\"several\"", "`known`"),
        ("solutions = 1", "solutions = 2", "`known`"),
        ("grains = 2", "grains = 3", "`grains` is 3"),
        ("mechanics = \"discs\"", "mechanics = \"spheres\"", "`mechanics`"),
        ("contacts = 2", "contacts = 2\ncolour = 1", "colour"),
    ] {
        change(&entry, from, to);
        check(word);
        fs::write(&entry, &whole).unwrap();
    }
    let answers = file(&study, &format!("answers/{id}.json.gz"));
    let right = fs::read(&answers).unwrap();
    for (wrong, word) in [
        (sealed("{\"solutions\":[[0.15,0.09]]}"), "not certified"),
        (sealed("{\"solutions\":[[0.15,0.1],[0.15,0.1]]}"), "one velocity"),
        (sealed("{\"solutions\":[[0.15]]}"), "1 values"),
        (sealed("{\"ray\":[0.15,0.1]}"), "does not prove"),
        (sealed("{\"best\":[0.15,0.1]}"), "are certified"),
        ("{\"solutions\":[[0.15,0.1]]}".to_owned(), "no checksum"),
    ] {
        fs::write(&answers, wrong).unwrap();
        check(word);
    }
    fs::write(&answers, right).unwrap();
    let frozen = study.folder().path().join("cases/frozen/pair.json");
    change(&frozen, "-0.05", "-0.06");
    check("it was changed");
}

#[test]
fn problem_without_solution_is_one_by_a_proof() {
    let study = Study::new();
    fs::copy(
        checkout().join("cases/closing-walls.toml"),
        study.folder().path().join("cases/closing-walls.toml"),
    )
    .unwrap();
    let recipe = "why = \"A test.\"\nlicence = \"CC0-1.0\"\n[[cases]]\ncase = \"closing-walls\"\naxes = { \"scene.friction\" = [0.0, 0.3] }\n";
    let recipe = write(study.folder(), "recipe.toml", recipe);
    study.gravel(&["collection", "make", text(&recipe)]).succeeded();
    let listed =
        study.gravel(&["collection", "list", "--only", "status=no-solution", "--ids"]).succeeded().stdout;
    assert_eq!(listed.lines().count(), 2);
    let checked = study.gravel(&["collection", "check"]).succeeded().stdout;
    assert_eq!(checked, "2 problems, 0 submissions: 0 faults\n");
    for id in listed.lines() {
        let answers = file(&study, &format!("answers/{id}.json.gz"));
        let proof = fs::read(&answers).unwrap();
        // One push of three proves nothing, nor does one that pulls.
        for ray in ["[1.0,0.0,0.0]", "[-1.0,-1.0,-1.0]", "[0.0,0.0,0.0]"] {
            fs::write(&answers, sealed(&format!("{{\"ray\":{ray}}}"))).unwrap();
            let checked = study.gravel(&["collection", "check"]).failed().stdout;
            assert!(checked.contains("does not prove") && checked.contains("1 faults"), "{checked}");
        }
        fs::write(&answers, proof).unwrap();
    }
}

#[test]
fn submission_is_judged_filed_and_certifies_an_open_problem() {
    let (study, id) = with_pair();
    opened(&study, &id);
    let worse = write(study.folder(), "worse.json", &submission(&id, &json!([0.06, 0.04])).to_string());
    let said = study.gravel(&["accept", text(&worse)]).succeeded().stdout;
    assert!(said.contains("not certified") && !said.contains("least natural map"), "{said}");
    let better = write(study.folder(), "better.json", &submission(&id, &json!([0.12, 0.08])).to_string());
    let said = study.gravel(&["accept", text(&better)]).succeeded().stdout;
    assert!(said.contains("the least natural map that is known"), "{said}");

    let r = write(study.folder(), "r.json", "{\"impulse\": [0.15, 0.1]}");
    let out = study.folder().path().join("theirs.json");
    let submit = [
        "submit",
        text(&r),
        "--problem",
        &id,
        "--code",
        "theirs",
        "--version",
        "2",
        "--seconds",
        "0.5",
        "-o",
    ];
    study.gravel(&[&submit[..], &[text(&out)]].concat()).succeeded();
    study.gravel(&[&submit[..], &[text(&out)]].concat()).refused(&["exists", "--force"]);
    let said = study.gravel(&["accept", "--dry-run", text(&out)]).succeeded().stdout;
    assert!(said.contains("nothing was filed"), "{said}");
    assert_eq!(entries(&file(&study, "submissions")).len(), 2, "those before");
    let said = study.gravel(&["accept", text(&out)]).succeeded().stdout;
    for words in ["natural map", "(verified), certified", "0.5 s (claimed)", "was open, and is certified now"]
    {
        assert!(said.contains(words), "no {words}: {said}");
    }
    let said = study.gravel(&["accept", text(&out)]).succeeded().stdout;
    assert!(said.contains("it was filed before"), "{said}");
    let shown = study.gravel(&["collection", "show", &id]).succeeded().stdout;
    assert!(shown.contains("status: certified, by theirs 2"), "{shown}");
    assert!(shown.contains("claimed: 0.5 s"), "{shown}");
    let checked = study.gravel(&["collection", "check", "--sample", "1"]).succeeded().stdout;
    assert_eq!(checked, "1 problems, 3 submissions: 0 faults\n");
}

#[test]
fn solutions_of_open_problems_are_sought_again() {
    let (study, id) = with_pair();
    study.gravel(&["collection", "seek", &id]).refused(&[&id, "it is certified"]);
    opened(&study, &id);
    let said = study.gravel(&["collection", "seek"]).succeeded().stdout;
    assert!(
        said.contains("pair: certified") && said.contains("better answers to 1 of 1 open problems"),
        "{said}"
    );
    let said = study.gravel(&["collection", "seek"]).succeeded().stdout;
    assert_eq!(said, "better answers to 0 of 0 open problems\n");
    study.gravel(&["collection", "check"]).succeeded();
}

/// The pair with friction: grains that may spin, on a floor and on each other.
fn rough_pair() -> Value {
    let mut pair = pair_with("/format", "gravel/contact-problem/2".into());
    pair["name"] = "rough-pair".into();
    pair["grains"]["inertia"] = json!([0.125, 0.25]);
    pair["grains"]["free_velocity"] = json!([[0.0, -0.05, 0.0], [0.0, -0.05, 0.0]]);
    pair["contacts"]["offset"] = json!([[0.0, 0.0], [0.0, 0.0]]);
    pair["contacts"]["friction"] = json!([0.3, 0.3]);
    pair
}

#[test]
fn frictional_impulses_near_a_solution_are_polished_to_it_and_outside_the_cone_refused() {
    let study = Study::new();
    let rough = write(study.folder(), "rough.json", &rough_pair().to_string());
    study.gravel(&["collection", "add", text(&rough), "--state", "rest"]).succeeded();
    let id = ids(&study).remove(0);
    fs::write(file(&study, &format!("answers/{id}.json.gz")), sealed("{\"best\":[0.07,0.0,0.05,0.0]}"))
        .unwrap();
    let slides = submission(&id, &json!([0.15, 0.0451, 0.1, 0.0]));
    let slides = write(study.folder(), "slides.json", &slides.to_string());
    let said = study.gravel(&["accept", text(&slides)]).ended(1).stdout;
    assert!(said.contains("`impulse` of contact 0 is") && said.contains("at most μ times"), "{said}");
    let near =
        write(study.folder(), "near.json", &submission(&id, &json!([0.151, 0.0, 0.1, 0.001])).to_string());
    study.gravel(&["accept", text(&near)]).succeeded();
    let shown = study.gravel(&["collection", "show", &id]).succeeded().stdout;
    assert!(shown.contains("status: certified"), "{shown}");
    study.gravel(&["collection", "check"]).succeeded();
}

#[test]
fn problem_of_w_alone_is_kept_by_the_hash_of_its_file() {
    let study = Study::new();
    let dump = "Box_Stacks-i0122-82-5.hdf5";
    let foreign = study.folder().path().join("cases/foreign");
    fs::create_dir_all(&foreign).unwrap();
    fs::copy(checkout().join("cases/foreign").join(dump), foreign.join(dump)).unwrap();
    let dump = foreign.join(dump);
    study.gravel(&["collection", "add", text(&dump)]).refused(&["--origin"]);
    study.gravel(&["collection", "add", text(&dump), "--origin", "Siconos"]).succeeded();
    let id = ids(&study).remove(0);
    let shown = study.gravel(&["collection", "show", &id]).succeeded().stdout;
    assert!(shown.contains("eed0bcae06d31f0a2d9606f1b1b9b521555b582312f108cfbf12f767177fa6fd"), "{shown}");
    assert!(shown.contains("status: solved"), "{shown}");
    assert!(!file(&study, "problems").exists(), "the file of another code is not copied");
    let solved = study.folder().path().join("r.json");
    let solve = ["solve", &id, "--method", "nsgs", "--tolerance", "1e-2", "--impulses", text(&solved)];
    study.gravel(&solve).succeeded();
    let solved: Value = serde_json::from_str(&fs::read_to_string(&solved).unwrap()).unwrap();
    let mut outside = vec![0.0; 3 * 82];
    outside[3] = 1.0;
    outside[4] = 1.0;
    let outside = write(study.folder(), "outside.json", &submission(&id, &json!(outside)).to_string());
    let said = study.gravel(&["accept", text(&outside)]).ended(1).stdout;
    assert!(said.contains("`impulse` of contact 1 is [1.0, 1.0, 0.0]"), "{said}");
    let solved = write(study.folder(), "solved.json", &submission(&id, &solved["impulse"]).to_string());
    study.gravel(&["accept", text(&solved)]).succeeded();
    fs::remove_file(&dump).unwrap();
    let checked = study.gravel(&["collection", "check"]).succeeded().stdout;
    assert!(checked.contains("1 are not stored"), "{checked}");
}

#[test]
fn false_submissions_are_refused_by_their_reason_and_the_others_of_a_folder_are_filed() {
    let (study, id) = with_pair();
    let folder = study.folder().path().join("many");
    fs::create_dir(&folder).unwrap();
    let put = |name: &str, content: &str| fs::write(folder.join(name), content).unwrap();
    let with = |key: &str, value: Value| {
        let mut all = submission(&id, &json!([0.15, 0.1]));
        all[key] = value;
        all.to_string()
    };
    let wrong = [
        ("a-unknown-problem", with("problem", "0123456789abcdef".into()), "no problem 0123456789abcdef"),
        ("b-no-id", with("problem", "../../etc".into()), "is no id of a problem"),
        ("c-wrong-problem", with("impulse", json!([0.1, 0.1, 0.1])), "has 3 values"),
        (
            "d-outside-the-cone",
            with("impulse", json!([0.15, -0.1])),
            "`impulse` of contact 1 is -0.1: it must be",
        ),
        ("e-not-finite", with("impulse", json!([0.15, null])), "impulse[1]"),
        (
            "f-claimed",
            with("claimed", json!({ "natural_map": 1e-3 })),
            "`claimed.natural_map` is 1e-3: the impulses have",
        ),
        (
            "g-verified",
            with("verified", json!({ "natural_map": 0.5, "certified": true })),
            "`verified` has natural_map",
        ),
        ("h-damaged", sealed(&with("code", "theirs".into())).replace("theirs", "others"), "checksum"),
        ("i-open-division", with("division", "open".into()), "`how` is empty"),
        ("j-format", with("format", "gravel/submission/9".into()), "`format`"),
        ("k-key", with("colour", 1.into()), "colour"),
        ("l-no-code", with("code", " ".into()), "`code` is empty"),
        ("m-seconds", with("claimed", json!({ "seconds": -1.0 })), "`claimed.seconds`"),
        ("n-huge", with("impulse", json!([1e308, 1e308])), "beyond all measure"),
        ("o-nothing", with("impulse", json!([0.0, 0.0])), "that of no impulses 1e0: it is no answer"),
    ];
    for (name, content, _) in &wrong {
        put(&format!("{name}.json"), content);
    }
    put("z-right.json", &with("code", "right".into()));
    let said = study.gravel(&["accept", text(&folder)]).ended(1).stdout;
    for (name, _, reason) in &wrong {
        let line = said.lines().find(|line| line.contains(name)).unwrap();
        assert!(line.starts_with("refused ") && line.contains(reason), "no {reason}: {line}");
    }
    assert!(said.ends_with(&format!("1 accepted, {} refused\n", wrong.len())), "{said}");
    assert_eq!(entries(&file(&study, "submissions")).len(), 1);
    // A file that was changed after it was filed is told, whether its checksum was made anew or not.
    let filed = file(&study, "submissions").join(&entries(&file(&study, "submissions"))[0]);
    let name = filed.file_name().unwrap().to_str().unwrap();
    let changed = with("verified", json!({ "natural_map": 0.0, "certified": true }));
    fs::write(&filed, sealed(&changed)).unwrap();
    let checked = study.gravel(&["collection", "check"]).failed().stdout;
    assert!(checked.contains("named after another submission") && checked.contains(&name[..16]), "{checked}");
}

#[test]
fn hidden_collection_is_made_of_secret_seeds_in_a_folder_of_its_own() {
    let study = Study::new();
    fs::copy(checkout().join("cases/settled-box.toml"), study.folder().path().join("cases/settled-box.toml"))
        .unwrap();
    let recipe = "why = \"A test.\"\nlicence = \"CC0-1.0\"\n[[cases]]\ncase = \"settled-box\"\ntime_step = 2\nscene = { \"sample.grains\" = 5, \"sample.seed\" = 1 }\n";
    let recipe = write(study.folder(), "recipe.toml", recipe);
    let seeds = write(study.folder(), "seeds", "411\n\n97\n");
    let hidden = study.folder().path().join("hidden");
    let make = ["collection", "make", text(&recipe), "--seeds-from", text(&seeds)];
    study.gravel(&make).refused(&["--seeds-from", "--in"]);
    study.gravel(&[&make[..], &["--in", text(&hidden)]].concat()).succeeded();
    assert!(!file(&study, "entries").exists(), "nothing of it is public");
    let promised = study.gravel(&["collection", "list", "--ids", "--in", text(&hidden)]).succeeded().stdout;
    assert_eq!(promised.lines().count(), 2);
    let none = write(study.folder(), "seeds", "411\nsecret\n");
    let make = ["collection", "make", text(&recipe), "--seeds-from", text(&none), "--in", text(&hidden)];
    study.gravel(&make).refused(&["line 2", "secret"]);
}

#[test]
fn what_is_asked_wrongly_is_refused_with_what_to_do() {
    let (study, id) = with_pair();
    study.gravel(&["collection", "show", "beef"]).refused(&["\"beef\" is no id", "16 digits"]);
    study.gravel(&["collection", "show", "0123456789abcdef"]).refused(&["collection list"]);
    study.gravel(&["solve", "0123456789abcdef"]).refused(&["0123456789abcdef", "collection show"]);
    study.gravel(&["collection", "list", "--only", "size=3"]).refused(&["--only size", "grains"]);
    study.gravel(&["collection", "make", "nothing.toml"]).refused(&["nothing.toml"]);
    study.gravel(&["collection", "list", "--in", "nowhere"]).refused(&["--in nowhere", "no such folder"]);
    study.gravel(&["accept", "x.json", "--in", "nowhere"]).refused(&["--in nowhere", "no such folder"]);
    study.gravel(&["collection", "make", &id]).succeeded();
    let r = write(study.folder(), "r.json", "{\"impulse\": [0.15, 0.1, 0.1]}");
    let submit = ["submit", text(&r), "--problem", &id, "--code", "mine", "--version", "1", "-o", "out.json"];
    study.gravel(&submit).refused(&["3 values", "2 contacts"]);
    let recipe = write(study.folder(), "recipe.toml", "why = \"A test.\"\ncases = []\n");
    study.gravel(&["collection", "make", text(&recipe)]).refused(&["recipe.toml", "licence"]);
}

#[test]
fn thirty_lines_of_python_solve_a_problem_of_the_collection_and_are_accepted() {
    let page = fs::read_to_string(checkout().join("cases/collection/README.md")).unwrap();
    let program = page.split_once("```python\n").unwrap().1.split_once("```").unwrap().0;
    assert!(program.lines().filter(|line| !line.trim().is_empty()).count() <= 32, "thirty lines or so");
    let study = Study::new();
    let solver = write(study.folder(), "solver.py", program);
    let r = study.folder().path().join("r.json");
    let listed = gravel(&["collection", "list", "--only", "grains=60", "--only", "mechanics=rough-discs"]);
    let listed = listed.succeeded().stdout;
    let id = &listed[..16];
    let problem = checkout().join(format!("cases/collection/problems/{id}.json.gz"));
    let ran = Command::new("python3").args([text(&solver), text(&problem), text(&r), "500"]).output();
    let Ok(ran) = ran else {
        eprintln!("skipped: python3 is not installed");
        return;
    };
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let out = study.folder().path().join("out.json");
    let submit =
        ["submit", text(&r), "--problem", id, "--code", "thirty-lines", "--version", "1", "-o", text(&out)];
    gravel(&submit).succeeded();
    let said = gravel(&["accept", "--dry-run", text(&out)]).succeeded().stdout;
    let natural_map = said.split_once("natural map ").unwrap().1.split_once(' ').unwrap().0;
    // r = 0 has 1.
    assert!(natural_map.parse::<f64>().unwrap() < 0.1, "{said}");
}

#[test]
fn collection_of_the_checkout_is_what_it_says() {
    let checked = gravel(&["collection", "check", "--sample", "12"]).succeeded().stdout;
    assert!(checked.starts_with("12 problems"), "{checked}");
}
