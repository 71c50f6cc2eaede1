//! Several users of one machine, each with their own domains: they do not see or affect each other.

use std::{path::Path, time::Duration};

use crate::world::{self, Actor, ROOT, User, files_of};

const ANNA: User = User { uid: 4001, gid: 4001 };
const CARL: User = User { uid: 4003, gid: 4003 };

#[test]
fn users_run_side_by_side() {
    world::run(64, true, side_by_side);
}

/// Runs in the domain of the same name, the default one, in either order.
fn side_by_side() {
    for (first, second) in
        [(ANNA, CARL), (CARL, ANNA), (ROOT, ANNA), (ANNA, ROOT), (ROOT, CARL), (CARL, ROOT)]
    {
        let case = format!("{first:?}, then {second:?}");
        let start = |role, user| Actor::start(role, "default", user, &[]);
        let (mut early, mut late) = (start("simulate", first), start("simulate", second));
        early.says("ready");
        late.says("ready");
        // Each user's frames and commands are separate.
        let mut driver = start("drive", first);
        driver.says("frame 3");
        early.says("command ");
        assert!(!late.has_said("command"), "{case}: a command of another user");
        let mut other_driver = start("drive", second);
        other_driver.says("frame 3");
        late.says("command ");
        // Each user sees the streams of one simulator, their own.
        for (user, simulator) in [(first, &early), (second, &late)] {
            let mut curious = start("try", user);
            assert_eq!(curious.says("open "), "ok", "{case}");
            assert_eq!(curious.says("streams "), "2", "{case}");
            let told = curious.says("publish ");
            assert!(told.contains(&format!("process {})", simulator.pid())), "{case}: {told}");
        }
        // The first is killed; the second is not affected.
        early.kill();
        driver.kill();
        late.forget();
        late.says("command ");
        // The next start of the first user cleans up only that user's files.
        let mut again = start("simulate", first);
        again.says("ready");
        late.forget();
        late.says("command ");
        for actor in [other_driver, late, again] {
            assert!(actor.leave().success(), "{case}");
        }
    }
    // The files of a process killed in its first second are removed by its user's first start after that second.
    std::thread::sleep(Duration::from_millis(1100));
    for user in [ANNA, CARL, ROOT] {
        assert!(Actor::start("simulate", "default", user, &[]).leave().success());
    }
    assert_eq!(files_of("default"), [] as [&Path; 0]);
}
