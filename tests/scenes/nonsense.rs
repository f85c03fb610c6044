//! Whatever can be typed: refused or built, never a panic.

use super::*;
use fuzzing::Random;

/// Tokens of the shipped scenes deleted, doubled, swapped and altered: refused or built, never a panic.
#[test]
fn mutated_scenes_never_panic() {
    let strange = [
        "-1",
        "0",
        "1e308",
        "nan",
        "\"\"",
        "[]",
        "{}",
        "true",
        "\"ground\"",
        "99999999999999999999",
        "[[bodies]]",
        "[time]",
        "=",
        "\"\"\"",
        "1979-05-27",
        "é",
        "type",
        "name",
    ];
    let mut random = Random(0x5eed);
    let mut refused = 0;
    for round in 0..600 {
        let builtin = BUILTIN_SCENES[round % BUILTIN_SCENES.len()];
        if builtin.name.ends_with("-fine") {
            continue;
        }
        let mut tokens = tokens_of(builtin.text);
        for _ in 0..=random.below(3) {
            let at = random.below(tokens.len());
            match random.below(4) {
                0 => drop(tokens.remove(at)),
                1 => tokens.insert(at, tokens[at].clone()),
                2 => tokens.swap(at, random.below(at.max(1))),
                _ => tokens[at] = strange[random.below(strange.len())].to_owned(),
            }
        }
        let text = tokens.concat();
        match build(&text, &[]) {
            Ok(_) => {}
            Err(error) => {
                refused += 1;
                assert!(!error.problems().is_empty());
                assert!(!error.to_string().is_empty());
            }
        }
    }
    assert!(refused > 200, "only {refused} refused: the mutations are too tame");
}

/// Overrides made of words of the scene, in any order and number.
#[test]
fn random_overrides_never_panic() {
    let text = BUILTIN_SCENES[0].text;
    let words: Vec<String> = tokens_of(text).into_iter().filter(|t| !t.trim().is_empty()).collect();
    let mut random = Random(0xbad5eed);
    for _ in 0..2000 {
        let path: Vec<&str> =
            (0..=random.below(3)).map(|_| words[random.below(words.len())].as_str()).collect();
        let glue = if random.below(10) == 0 { "[" } else { "=" };
        let value = &words[random.below(words.len())];
        let text_of_override = format!("{}{glue}{value}", path.join("."));
        if let Err(error) = build(text, &[&text_of_override]) {
            assert!(!error.problems().is_empty(), "{text_of_override}");
        }
    }
}

#[test]
fn fuzzed_scenes_are_refused_or_sound() {
    fuzzing::run("scene", 700, entries::scene);
}

#[test]
fn fuzzed_formulas_are_refused_or_have_values() {
    fuzzing::run("formula", 20_000, entries::formula);
}

/// Refused by count, before ten thousand meshes are made.
#[test]
fn copies_beyond_all_memory_are_refused() {
    let refused = build(include_str!("../corpus/scene/many_copies.toml"), &[]).unwrap_err().to_string();
    assert!(refused.contains("1620000000 elements"), "{refused}");
}

/// Nesting is recursion: neither text nor overrides may use up the stack.
#[test]
fn depth_without_end_is_refused() {
    let smallest = include_str!("../corpus/scene/smallest.toml");
    for depth in [100, 100_000] {
        let dotted = vec!["a"; depth].join(".");
        let brackets = "[".repeat(depth) + &"]".repeat(depth);
        let tables = "{a=".repeat(depth) + "1" + &"}".repeat(depth);
        for text in [
            format!("{dotted} = 1\n{smallest}"),
            format!("{smallest}\n[{dotted}]\n"),
            format!("{smallest}\n[[{dotted}]]\n"),
        ]
        .into_iter()
        .chain([&brackets, &tables].map(|value| format!("a = {value}\n{smallest}")))
        {
            assert!(build(&text, &[]).is_err(), "{depth}: {}", &text[..40]);
        }
        for value in ["1", &brackets, &tables] {
            for path in [&dotted, "bodies", "time.duration"] {
                let text = format!("{path}={value}");
                assert!(build(smallest, &[&text]).is_err() || *path != *dotted, "{depth}: {}", &text[..20]);
            }
        }
    }
    let formula = "(".repeat(100_000) + "s1" + &")".repeat(100_000);
    entries::formula(formula.as_bytes());
    entries::formula("-".repeat(100_000).as_bytes());
    entries::formula("s1^".repeat(100_000).as_bytes());
    entries::formula("s1+".repeat(100_000).as_bytes());
}

/// Words, numbers, blanks and signs, which together are the text again.
fn tokens_of(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let kind = |c: char| match c {
        c if c.is_alphanumeric() || "_-.".contains(c) => 0,
        c if c.is_whitespace() => 1,
        _ => 2,
    };
    let mut last = 3;
    for c in text.chars() {
        match tokens.last_mut() {
            Some(token) if kind(c) == last && last < 2 => token.push(c),
            _ => tokens.push(c.to_string()),
        }
        last = kind(c);
    }
    tokens
}
