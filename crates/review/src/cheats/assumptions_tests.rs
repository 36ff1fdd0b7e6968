//! An acknowledgment of what the world does is of every delay and choice of its branch, each at its place and with its bounds.

use super::*;

/// A mission in which the world does this. What it does moves no windows of the plan.
fn mission(world: &str) -> String {
    format!(
        "var A : {{ON, OFF}}; var B : {{ON, OFF}}; var C : {{ON, OFF}}; primitive Dig()[4,4];
        Wait() = {{ delay[1,2]; A=ON [1,1] }}
        scenario Day[0,90] = {{ {{ Dig(); Dig() }}, {{ {world} }} }}"
    )
}

/// A board that has acknowledged everything about a mission, and approved it.
fn acknowledged(world: &str) -> Board {
    let mut board = Board::new(&mission(world));
    for line in unacknowledged(&board) {
        board.say("Ada", Act::Acknowledge { line, text: "As meant.".to_owned() });
    }
    board.approve("Ada");
    board.approve("Grace");
    assert_eq!(board.status(), PlanStatus::Approved, "{world}");
    board
}

/// The assumptions that are not acknowledged after the world was changed, and two people have approved it again.
fn open_after(board: &Board, world: &str) -> Vec<String> {
    let source = mission(world);
    let mut review = reviewed(&source);
    review.judge(board.record.rules(), None);
    let mut later = Board { review, source, record: board.record.clone(), minute: board.minute };
    later.approve("Ada");
    later.approve("Grace");
    let open = unacknowledged(&later);
    let open: Vec<String> =
        open.into_iter().map(|line| line.text).filter(|it| it.starts_with("assumes")).collect();
    assert_eq!(later.status().is_approved(), open.is_empty(), "{world}");
    open
}

#[test]
fn an_acknowledgment_of_a_branch_is_of_each_of_its_delays() {
    let world = "delay[5,20]; A=ON [1,1]; delay[1,2]; B=ON [5,5]; C=ON [5,5]";
    let board = acknowledged(world);
    let text = "assumes favorable timing of external events: `delay` allows [5,20], and `delay` allows [1,2]";
    assert!(board.review.plan.iter().any(|line| line.text == text), "{:?}", board.review.plan);
    assert!(open_after(&board, world).is_empty());
    for changed in [
        "delay[5,20]; A=ON [1,1]; B=ON [5,5]; delay[1,2]; C=ON [5,5]",
        "delay[5,20]; A=ON [1,1]; B=ON [5,5]; delay[1,40]; C=ON [5,5]",
        "delay[5,20]; A=ON [1,1]; delay[1,3]; B=ON [5,5]; C=ON [5,5]",
        "delay[5,20]; A=ON [1,1]; delay[1,2]; C=ON [5,5]; B=ON [5,5]",
        "delay[1,2]; A=ON [1,1]; delay[5,20]; B=ON [5,5]; C=ON [5,5]",
    ] {
        let open = open_after(&board, changed);
        assert!(open.len() == 1 && open[0].starts_with("assumes favorable timing"), "{changed}: {open:?}");
    }
    // Those that the text does not list count as well.
    let many = |last: &str| {
        let before = "delay[1,2]; A=ON [1,1]; ".repeat(5);
        format!("{before}{last}; B=ON [5,5]; C=ON [5,5]")
    };
    let board = acknowledged(&many("delay[1,2]"));
    assert!(
        board.review.plan.iter().any(|line| line.text.ends_with(", and 2 more")),
        "{:?}",
        board.review.plan
    );
    for changed in [many("delay[1,3]"), many("B=ON [5,5]; delay[1,2]")] {
        assert_eq!(open_after(&board, &changed).len(), 1, "{changed}");
    }
    // An activity of the world's that waits is called elsewhere.
    let board = acknowledged("Wait(); B=ON [5,5]; C=ON [5,5]");
    assert_eq!(open_after(&board, "B=ON [5,5]; Wait(); C=ON [5,5]").len(), 1);
}

#[test]
fn an_acknowledgment_of_a_choice_is_of_each_of_its_alternatives() {
    let world =
        "choose { { delay[5,20]; delay[2,2] }, delay[1,1] }; choose { A=ON [1,1], B=ON [2,2] }; C=ON [5,5]";
    let board = acknowledged(world);
    let text = "assumes favorable external events: one of the 2 alternatives of `choose`, and one of the 2 alternatives of `choose`";
    assert!(board.review.plan.iter().any(|line| line.text == text), "{:?}", board.review.plan);
    assert!(open_after(&board, world).is_empty());
    // The delay moves to the other alternative: both its own line and that of the choice are others.
    let moved =
        "choose { delay[2,2], { delay[5,20]; delay[1,1] } }; choose { A=ON [1,1], B=ON [2,2] }; C=ON [5,5]";
    let open = open_after(&board, moved);
    assert!(open.len() == 2 && open[0] != open[1], "{open:?}");
    // The second choice has other events, other bounds, or is elsewhere.
    for changed in [
        world.replace("B=ON [2,2] }", "C=ON [2,2] }"),
        world.replace("B=ON [2,2] }", "B=ON [3,3] }"),
        world.replace("; C=ON [5,5]", "").replace("; choose", "; C=ON [5,5]; choose"),
    ] {
        let open = open_after(&board, &changed);
        assert!(
            open.iter().any(|it| it.starts_with("assumes favorable external events")),
            "{changed}: {open:?}"
        );
    }
}
