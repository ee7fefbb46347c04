"""Files named in a study file: by content, relative to it, carried along, and refused in words."""

import pickle

import pytest
from pydantic import ValidationError

from pipeline.study.attachments import File
from pipeline.study.reading import describe
from pipeline.study.tables import Table


class Holder(Table):
    file: File


def holder(folder, name):
    return Holder.model_validate({"file": name}, context={"folder": folder})


def test_a_file_is_its_content_and_not_its_path(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"1,2\n")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_bytes(b"1,2\n")
    a, c = holder(tmp_path, "a.csv"), holder(tmp_path, "b/c.csv")
    assert a == c and hash(a) == hash(c)
    assert a.model_dump(mode="json") == c.model_dump(mode="json")
    (tmp_path / "a.csv").write_bytes(b"1,3\n")
    assert holder(tmp_path, "a.csv").model_dump(mode="json") != c.model_dump(mode="json")


def test_the_content_travels_packed_and_needs_no_file(tmp_path):
    data = b"0.1,0.2,0.3\n" * 10_000
    (tmp_path / "a.csv").write_bytes(data)
    sent = pickle.dumps(holder(tmp_path, "a.csv"))
    (tmp_path / "a.csv").unlink()
    assert len(sent) < len(data) / 10
    assert pickle.loads(sent).file.data == data


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no.csv", "no such file: "),
        (".", "is a folder: "),
        ("/dev/zero", "no such file: "),
        ("x" * 5000, "cannot be read: "),
        ("", "must be the path"),
        (3, "must be the path"),
        ("\0", "no such file: "),
    ],
)
def test_what_is_no_file_is_refused(tmp_path, name, message):
    with pytest.raises(ValidationError) as caught:
        holder(tmp_path, name)
    (line,) = map(describe, caught.value.errors())
    assert line.startswith("file = ") and message in line
