use super::*;

/// Cycles of a crate given as names and texts of its files.
fn found(files: &[(&str, &str)]) -> Vec<Cycle> {
    let read = |file: &path::Path| {
        let text = files.iter().find(|(name, _)| path::Path::new(name) == file).map(|(_, text)| (*text).to_owned());
        text.ok_or_else(|| format!("{} is missing", file.display()))
    };
    cycles(&Crate::parse(path::Path::new("lib.rs"), &read).unwrap())
}

fn nodes(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    found(files).into_iter().map(|cycle| cycle.nodes).collect()
}

#[test]
fn a_cycle_of_two_is_found_with_both_places() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B;\npub struct A;"),
        ("b.rs", "\npub struct B(super::a::A);"),
    ];
    let cycles = found(&files);
    assert_eq!(cycles.len(), 1);
    assert_eq!(cycles[0].nodes, ["a", "b"]);
    assert_eq!(cycles[0].dependencies, ["  a -> b: a.rs:1 uses crate::b::B", "  b -> a: b.rs:2 uses super::a::A"]);
}

#[test]
fn a_cycle_of_three_is_found_and_names_no_other_module() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c; mod d;"),
        ("a.rs", "fn a() { crate::b::b() }"),
        ("b.rs", "use super::c;\npub fn b() { c::c() }"),
        ("c.rs", "pub fn c() { assert!(crate::a::X > 0) }"),
        ("d.rs", "use crate::{a::*, b, c};"),
    ];
    assert_eq!(nodes(&files), [["a", "b", "c"]]);
}

#[test]
fn layers_are_no_cycle() {
    let files = [
        ("lib.rs", "mod a; mod b;\npub use a::A;\npub use b::B;"),
        ("a.rs", "pub struct A;"),
        ("b.rs", "use crate::A;\npub struct B(A);\n#[cfg(test)] mod tests { use crate::B; }"),
    ];
    assert!(nodes(&files).is_empty());
}

#[test]
fn re_exports_are_followed_to_the_definition() {
    let files = [
        ("lib.rs", "mod a; mod b;\npub use a::A;\npub use b::*;"),
        ("a.rs", "use crate::B;\npub struct A;"),
        ("b.rs", "use crate::A;\npub struct B;"),
    ];
    assert_eq!(nodes(&files), [["a", "b"]]);
}

#[test]
fn a_parent_and_its_child_must_not_use_each_other() {
    let child = ("a/b.rs", "use super::A;\npub struct B;");
    let user = ("a/mod.rs", "mod b;\nuse b::B;\npub struct A;");
    let exporter = ("a/mod.rs", "mod b;\npub use b::B;\npub struct A;");
    assert_eq!(nodes(&[("lib.rs", "mod a;"), user, child]), [["a", "a::b"]]);
    assert!(nodes(&[("lib.rs", "mod a;"), exporter, child]).is_empty());
}

#[test]
fn folders_must_not_use_each_other_even_if_their_files_form_no_cycle() {
    let files = [
        ("lib.rs", "mod a { pub mod x; pub mod y; } mod b { pub mod x; pub mod y; }"),
        ("a/x.rs", "use crate::b::x::X;"),
        ("a/y.rs", "pub struct Y;"),
        ("b/x.rs", "pub struct X;"),
        ("b/y.rs", "use crate::a::y::Y;"),
    ];
    assert_eq!(nodes(&files), [["a", "b"]]);
}

#[test]
fn names_of_other_crates_and_of_types_are_not_modules() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use b::X;\nuse ::b::Y;\npub(crate) struct A;\nimpl A { fn f() { Self::f(); Vec::<u8>::new(); } }"),
        ("b.rs", "use crate::a::A;\n/// [`crate::a::A`]\n#[doc = \"crate::a::A\"]\nstruct B(A);"),
    ];
    assert!(nodes(&files).is_empty());
}
