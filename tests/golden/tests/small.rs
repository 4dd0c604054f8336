//! The small captures in this build. `cargo test` has overflow checks and debug assertions.

use golden::{Detail, RENEW, case::SMALL, difference, file, measure, preset};

#[test]
fn small_captures_give_the_golden_values() {
    for case in SMALL {
        let expected = file::find(include_str!("../golden.txt"), case.name).expect("the file is sound");
        let preset = preset(case.preset).expect("a case has a known preset");
        let got = measure(&case.render(), preset, Detail::Sample).expect("the capture can be reconstructed");
        if let Some(difference) = difference(&expected, &got) {
            panic!("{}: {difference}{RENEW}", case.name);
        }
    }
}
