//! What is in a place before, under way and after, and what stays beside it.

use std::collections::BTreeSet;

use super::*;

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries
        .map(|it| it.unwrap().file_name().into_string().unwrap())
        .collect()
}

fn only(folder: &Path, expected: &[&str]) {
    let expected = expected.iter().map(|&it| it.to_owned()).collect();
    assert_eq!(names(folder), expected);
}

#[test]
fn the_old_file_stays_until_the_new_one_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.svg");
    fs::write(&path, "old").unwrap();
    let part = NewFile::at(&path, Existing::Replace).unwrap();
    only(folder.path(), &["a.svg"]);
    let part = part.begin().unwrap();
    assert_eq!(part.path().extension().unwrap(), "svg");
    fs::write(part.path(), "half").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(folder.path()).len(), 2);
    fs::write(part.path(), "new").unwrap();
    part.put_in_place().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    only(folder.path(), &["a.svg"]);
}

/// Given up, it leaves neither a file nor a folder.
#[test]
fn nothing_is_left_of_a_file_that_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a/b/c.svg");
    drop(NewFile::at(&path, Existing::Keep).unwrap());
    only(folder.path(), &[]);
    let part = NewFile::at(&path, Existing::Keep).unwrap().begin().unwrap();
    drop(part);
    only(folder.path(), &[]);
    let place = NewFile::at(&path, Existing::Keep).unwrap();
    // Somebody who makes a file beside it gives up in between.
    fs::remove_dir_all(folder.path().join("a")).unwrap();
    place.write(b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
}

/// What appears in the meantime is not replaced unless that was asked for.
#[test]
fn of_two_writers_that_replace_nothing_the_first_wins() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.svg");
    let [first, second] = [(); 2].map(|()| NewFile::at(&path, Existing::Keep).unwrap());
    let parts = [first.begin().unwrap(), second.begin().unwrap()];
    let [first, second] = parts;
    assert_ne!(first.path(), second.path());
    fs::write(first.path(), "first").unwrap();
    first.put_in_place().unwrap();
    let refusal = second.put_in_place().unwrap_err();
    assert!(
        matches!(refusal, WriteError::FileExists { .. }),
        "{refusal}"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "first");
    only(folder.path(), &["a.svg"]);
}

#[test]
fn a_folder_a_link_a_device_and_a_name_of_a_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("folder")).unwrap();
    fs::write(at.join("file"), "somebody's").unwrap();
    let mut places = vec![at.join("folder"), at.join("new/"), at.join("..")];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("file", at.join("link")).unwrap();
        std::os::unix::fs::symlink("nowhere", at.join("dangling")).unwrap();
        places.extend([at.join("link"), at.join("dangling"), "/dev/null".into()]);
    }
    for place in places {
        let refusal = NewFile::at(&place, Existing::Replace).unwrap_err();
        assert!(matches!(refusal, WriteError::Foreign { .. }), "{refusal}");
    }
    let below = NewFile::at(&at.join("file/new"), Existing::Replace).unwrap_err();
    assert!(matches!(below, WriteError::Io { .. }), "{below}");
    assert_eq!(fs::read_to_string(at.join("file")).unwrap(), "somebody's");
}

/// A new file has the rights of any new file, and one that replaces another has those of that.
#[cfg(unix)]
#[test]
fn rights_are_those_of_other_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |name: &str| {
        let about = fs::metadata(folder.path().join(name)).unwrap();
        about.permissions().mode()
    };
    fs::write(folder.path().join("usual"), "").unwrap();
    let path = folder.path().join("new");
    let write = |existing| NewFile::at(&path, existing).and_then(|it| it.write(b"new"));
    write(Existing::Keep).unwrap();
    assert_eq!(mode("new"), mode("usual"));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    write(Existing::Replace).unwrap();
    assert_eq!(mode("new") & 0o777, 0o640);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    assert!(write(Existing::Replace).is_err());
}

/// Names as long as a system takes have room beside them.
#[test]
fn the_longest_name_can_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{}.svg", "n".repeat(251)));
    let place = NewFile::at(&path, Existing::Keep).unwrap();
    place.write(b"new").unwrap();
    assert_eq!(fs::read(path).unwrap(), b"new");
}
