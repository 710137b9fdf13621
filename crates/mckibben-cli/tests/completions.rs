//! `mckibben completions`: the script of Bash, in Bash, and those of Zsh and Fish where these are installed.

use crate::common::Folder;
use std::process::Command;

fn script(folder: &Folder, shell: &str) -> String {
    let output = folder.mckibben().args(["completions", shell]).output().expect("the program runs");
    assert!(output.status.success());
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// What Bash offers at the end of words that it has split, as it does at spaces and at `=`.
#[cfg(unix)]
fn offered(folder: &Folder, words: &[&str]) -> Vec<String> {
    let program = env!("CARGO_BIN_EXE_mckibben");
    let words =
        std::iter::once(&program).chain(&words[1..]).map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" ");
    let query = format!(
        "source ./script\ncomplete -p mckibben >&2\nCOMP_WORDS=({words})\nCOMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n\
         _mckibben_or_keys '{program}' \"${{COMP_WORDS[COMP_CWORD]}}\" \"${{COMP_WORDS[COMP_CWORD-1]}}\"\n\
         printf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
    );
    let output = Command::new("bash").args(["-c", &query]).current_dir(folder.path(".")).output().expect("bash");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.contains("-F _mckibben_or_keys mckibben"), "{errors}");
    String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect()
}

#[cfg(unix)]
#[test]
fn bash_completes_keys() {
    let folder = Folder::new("completions");
    folder.file("script", &script(&folder, "bash"));
    let of = |words: &[&str]| offered(&folder, words);
    // A key ends with the = before its value, a section with the point before its keys.
    assert_eq!(of(&["mckibben", "simulate", "muscle.toml", "--set", "load.mass"]), ["load.mass="]);
    assert_eq!(of(&["mckibben", "sweep", "muscle.toml", "-s", "sweep.see"]), ["sweep.seed="]);
    assert_eq!(of(&["mckibben", "simulate", "--set", "=", "load.mass"]), ["load.mass="]);
    assert_eq!(of(&["mckibben", "design", "muscle.toml", "--vary", "supply.gauge_p"]), ["supply.gauge_pressure="]);
    assert_eq!(of(&["mckibben", "simulate", "--set", "actuator.fri"]), ["actuator.friction."]);
    assert_eq!(of(&["mckibben", "simulate", "--set", "antagonist.valve.preset"]), ["antagonist.valve.preset="]);
    assert_eq!(of(&["mckibben", "simulate", "--set", "actuators.flexor.tur"]), ["actuators.flexor.turns="]);
    assert_eq!(of(&["mckibben", "keys", "command.freq"]), ["command.frequency"]);
    // Everything else is as before.
    assert_eq!(of(&["mckibben", "simulate", "muscle.toml", "--engi"]), [""]);
    assert!(of(&["mckibben", "simulate", "--ver"]).contains(&"--verbose".to_owned()));
    assert!(of(&["mckibben", "sim"]).contains(&"simulate".to_owned()));
}

/// What `keys --names` prints leads from section to section to every key of the table that has no name of the file in its path.
#[test]
fn every_key_is_reached_by_its_parts() {
    let folder = Folder::new("names");
    let below = |text: &str| {
        let output = folder.mckibben().args(["keys", "--names", text]).output().expect("the program runs");
        String::from_utf8(output.stdout).expect("UTF-8").lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (mut open, mut keys) = (below(""), std::collections::BTreeSet::new());
    while let Some(path) = open.pop() {
        match path.ends_with('.') {
            // The keys of the second actuator are those of the first, and their sections hold no section of a second.
            true => open.extend(below(&path)),
            false => drop(keys.insert(path)),
        }
    }
    for key in mckibben_scenario::keys::all_keys().filter(|key| !key.path.contains('*')) {
        assert!(keys.contains(key.path), "{} is not reached", key.path);
    }
    for key in &keys {
        assert!(mckibben_scenario::keys::key_for(key).is_some(), "{key} is no key");
    }
}

/// The scripts are read without mistakes by their shells, and query the program for keys. Shells that are not here are left out.
#[cfg(unix)]
#[test]
fn zsh_and_fish_read_their_scripts() {
    let folder = Folder::new("shells");
    for shell in ["zsh", "fish"] {
        let script = script(&folder, shell);
        assert!(script.contains("keys --names") && script.matches("_mckibben_keys").count() > 8, "{script}");
        folder.file(shell, &script);
        let Ok(output) = Command::new(shell).args(["-n", shell]).current_dir(folder.path(".")).output() else {
            continue;
        };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_mckibben")).parent().expect("a folder").display();
    let queries = [
        (
            "fish",
            format!("set -x PATH {program} $PATH; source fish; complete -C 'mckibben simulate a.toml --set load.mass'"),
        ),
        // What the function hands to the shell, whose widget needs a terminal.
        (
            "zsh",
            format!(
                "PATH={program}:$PATH; compdef() {{ }}; compadd() {{ [[ $# -lt 4 ]] || print -r -- $4$2 }}; \
                 source ./zsh; PREFIX=load.mass; _mckibben_keys ="
            ),
        ),
    ];
    for (shell, query) in queries {
        let Ok(output) = Command::new(shell).args(["-c", &query]).current_dir(folder.path(".")).output() else {
            continue;
        };
        let offered = String::from_utf8_lossy(&output.stdout);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(offered.lines().any(|line| line.trim_end() == "load.mass="), "{shell}: {offered}{errors}");
    }
}
