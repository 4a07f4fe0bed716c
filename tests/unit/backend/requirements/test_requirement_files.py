"""ReqIF and CSV files of requirements: what is read, what is refused, what is written and read again."""

from __future__ import annotations

import csv
import hashlib
import io
import os
from pathlib import Path

import pytest

from backend.requirements import reqif, sheet, table
from backend.requirements.reqif import CannotRead, Read
from backend.requirements.schemas import RequirementRow

WRITTEN = Path(__file__).parents[3] / "api" / "requirements" / "written.reqif"
PUBLIC = os.environ.get("CLEARANCE_REQIF_EXAMPLES", "")
"""A folder of public ReqIF files, such as a clone of strictdoc-project/reqif."""


def test_ids_texts_and_attributes_of_a_reqif_file() -> None:
    found, skipped = reqif.read(WRITTEN.read_bytes())
    text = "The vehicle shall keep 0.5 m from obstacles.\nalso those that move"
    assert found == [
        Read("SYS-1", text, {"Level": "DAL A, DAL B"}),
        Read("SYS-2", "It shall reach its goal < 60 s.", {"Order": "7"}),
    ]
    assert skipped == 1, "the heading"


def test_the_attributes_may_be_named() -> None:
    found, skipped = reqif.read(WRITTEN.read_bytes(), "reqif.foreignid", "Order")
    assert ([(one.id, one.text) for one in found], skipped) == ([("SYS-2", "7")], 2)
    with pytest.raises(CannotRead, match="an object has no value of the attribute 'Order'; the file has"):
        reqif.read(WRITTEN.read_bytes(), "Order")


def test_a_written_reqif_file_is_read_again() -> None:
    rows = [('A & "1"', "Keep < 5 m,\nalways", "met", "A: R-0001."), ("é", "x\x0by", "no evidence", "")]
    found, _ = reqif.read(reqif.write(rows, 0.0, "Clearance"))
    assert [(one.id, one.text) for one in found] == [('A & "1"', "Keep < 5 m,\nalways"), ("é", "x\ufffdy")]
    assert found[0].attributes == {"Clearance.Status": "met", "Clearance.Sentence": "A: R-0001."}


TYPE = """<REQ-IF><SPEC-ATTRIBUTES>
<ATTRIBUTE-DEFINITION-XHTML IDENTIFIER="x" LONG-NAME="ReqIF.Text"/>
<ATTRIBUTE-DEFINITION-STRING IDENTIFIER="n1" LONG-NAME="Note"/>
<ATTRIBUTE-DEFINITION-STRING IDENTIFIER="n2" LONG-NAME="Note"/>
</SPEC-ATTRIBUTES>{more}</REQ-IF>"""
OBJECT = """<SPEC-OBJECT IDENTIFIER="{key}" DESC="described"><VALUES>{values}</VALUES></SPEC-OBJECT>"""
XHTML = """<ATTRIBUTE-VALUE-XHTML><DEFINITION><X>{of}</X></DEFINITION><THE-VALUE><div>{value}</div></THE-VALUE>
</ATTRIBUTE-VALUE-XHTML>"""
STRING = """<ATTRIBUTE-VALUE-STRING THE-VALUE="{value}"><DEFINITION><X>{of}</X></DEFINITION></ATTRIBUTE-VALUE-STRING>"""

EMBEDDED = "data:image/png;base64,AAAA"
RICH = {
    "10<sup>3</sup>": "10^3",
    "10<sup> -6</sup>.": "10^-6.",
    "10<b><sup><i>−6</i></sup></b> s": "10^−6 s",
    "10<sup>3</sup>4, 10<sup>3</sup>.5": "10^(3)4, 10^(3).5",
    "10<sup>0.5</sup> 2<sup>n+1</sup>": "10^(0.5) 2^(n+1)",
    "H<sub>2</sub>O": "H_(2)O",
    "x<sub>i</sub><sup>2</sup>": "x_i^2",
    "x<sub>i<sup>2</sup></sub>": "x_(i^2)",
    "a<sup> </sup>b": "ab",
    "<table><tr><th>m</th> <th>s</th></tr><tr><td>0.5</td><td>2</td></tr></table>": "m | s\n0.5 | 2",
    "<tr><td/><td>2</td></tr><tr><td/><td/></tr>": "| 2",
    "<tr><td><p>10</p><p>20</p></td><td><p>3<sup>2</sup></p></td></tr>": "10; 20 | 3^2",
    "<dl><dt>a</dt><dd>b</dd></dl>c<pre>d</pre>e<blockquote>f</blockquote>": "a\nb\nc\nd\ne\nf",
    "1<h5>2</h5><h6>3</h6><table><caption>4</caption></table>5": "1\n2\n3\n4\n5",
    "keep <del>1</del><ins>0.5</ins> m, 10<ins>0</ins>": "keep [deleted: 1][inserted: 0.5] m, 10[inserted: 0]",
    "<s>1</s>0.5<strike>2</strike>3 <del> </del>": "[deleted: 1]0.5[deleted: 2]3",
    "<span style='text-decoration: line-through'>1</span>0.5": "[deleted: 1]0.5",
    "<p style='color:red;TEXT-DECORATION-LINE : underline  line-through'>1</p>2": "[deleted: 1]\n2",
    "<del><p>1</p><p>2</p></del>3": "[deleted: 1 2]3",
    "<span style='text-decoration: underline; color: green'>1</span>0": "10",
    "<tr style='text-decoration:line-through'><td>1</td><td>2</td></tr>": "[deleted: 1 | 2]",
    "<tr><td style='text-decoration:line-through'>1</td><td><ins>2</ins></td></tr>": "[deleted: 1] | [inserted: 2]",
    "<del><img src='a.png'/></del><img style='text-decoration:line-through' src='b'/>": (
        "[deleted: [picture a.png]][deleted: [picture b]]"
    ),
    "10<sup><del>3</del>4</sup><del>x<sub>i</sub></del>": "10^([deleted: 3]4)[deleted: x_i]",
    "10<span style='vertical-align: super'>3</span>, x<span style='vertical-align:sub'>i</span>": "10^3, x_i",
    "see <object data='fig.png' type='image/png'/>.": "see [picture fig.png].",
    "<object data='a.rtf'><object data='a.png'>words</object></object>": "[picture a.rtf] [picture a.png] words",
    "<img src='a.png' alt='A'/><img alt='a  curve'/><img/>": "[picture a.png][picture a curve][picture without a name]",
    f"<img src='{EMBEDDED}'/>": f"[picture image/png {hashlib.sha256(EMBEDDED.encode()).hexdigest()[:12]}]",
}


def imported(xhtml: str) -> Read:
    values = XHTML.format(of="x", value=xhtml)
    ((one,), _) = reqif.read(TYPE.format(more=OBJECT.format(key="a", values=values)).encode())
    return one


@pytest.mark.parametrize("xhtml", RICH)
def test_rich_text_keeps_what_changes_its_meaning_and_its_export_is_read_as_the_same(xhtml: str) -> None:
    one = imported(xhtml)
    assert one.text == RICH[xhtml]
    (again,), _ = reqif.read(reqif.write([(one.id, one.text, "", "")], 0.0, "Clearance"))
    assert again.text == one.text


def test_deeply_nested_scripts_are_read() -> None:
    assert imported("a" + "<sup>b" * 80 + "</sup>" * 80).text == "a" + "^(b" * 79 + "^b" + ")" * 79


def test_attributes_of_the_same_name_are_numbered_in_the_order_of_their_definitions() -> None:
    both, second, twice = (
        "".join(STRING.format(of=of, value=value) for of, value in given)
        for given in ([("n2", "2"), ("n1", "1")], [("n2", "2")], [("n1", "1"), ("n1", "x")])
    )
    content = TYPE.format(more="".join(OBJECT.format(key=i, values=v) for i, v in enumerate((both, second, twice))))
    found, _ = reqif.read(content.encode())
    assert [one.attributes for one in found] == [
        {"Note": "1", "Note (2)": "2"}, {"Note (2)": "2"}, {"Note": "1", "Note (2)": "x"},
    ]  # fmt: skip


def test_types_of_objects_share_the_names_of_their_attributes() -> None:
    other = '<SPEC-ATTRIBUTES><ATTRIBUTE-DEFINITION-STRING IDENTIFIER="y" LONG-NAME="ReqIF.Text"/></SPEC-ATTRIBUTES>'
    objects = OBJECT.format(key="a", values=XHTML.format(of="x", value="1")) + OBJECT.format(
        key="b", values=STRING.format(of="y", value="2")
    )
    found, _ = reqif.read(TYPE.format(more=other + objects).encode())
    assert found == [Read("a", "1", {}), Read("b", "2", {})]


def test_numbered_names_are_unique_and_not_longer_than_names_may_be() -> None:
    assert reqif.numbered(["a", "a", "a (2)", "a", "", "", "b"]) == ["a", "a (3)", "a (2)", "a (4)", "", "", "b"]
    long = reqif.numbered(["n" * 300, "n" * 200, "n" * 199])
    assert (len(set(long)), max(map(len, long))) == (3, 200)


LAUGHS = b'<!DOCTYPE l [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;">]><REQ-IF>&b;</REQ-IF>'
OUTSIDE = b'<!DOCTYPE l [<!ENTITY a SYSTEM "file:///etc/passwd">]><REQ-IF>&a;</REQ-IF>'


@pytest.mark.parametrize(
    ("content", "statement"),
    [
        (LAUGHS, "document type declaration"),
        (OUTSIDE, "document type declaration"),
        (b'<!DOCTYPE l SYSTEM "http://127.0.0.1/x.dtd"><REQ-IF/>', "document type declaration"),
        (b"<REQ-IF>" + b"<a>" * 100_000, "deeper than 100 levels"),
        (b"<html/>", "its root element is html, expected REQ-IF"),
        (b"", "not readable as XML"),
        (b"PK\x03\x04", "unpack it"),
        (b'<?xml version="1.0" encoding="nope"?><REQ-IF/>', "not readable as XML: unknown encoding"),
        ("<REQ-IF>é</REQ-IF>".encode("latin-1"), "not readable as XML"),
        (b"<REQ-IF/>", "no object of the file has a text (0 objects)"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_file_that_is_no_acceptable_reqif_is_refused_with_a_sentence(content: bytes, statement: str) -> None:
    with pytest.raises(CannotRead, match=r".*") as refused:
        reqif.read(content)
    assert statement in str(refused.value)


def test_a_file_with_too_many_elements_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reqif, "MOST_ELEMENTS", 50)
    with pytest.raises(CannotRead, match="more than 50 elements: export fewer objects at a time"):
        reqif.read(WRITTEN.read_bytes())


def test_an_attribute_that_no_object_has_names_those_of_the_file() -> None:
    with pytest.raises(CannotRead, match=r"the file has the attributes Level, Order, ReqIF.ChapterName"):
        reqif.read(WRITTEN.read_bytes(), "", "Nope")


@pytest.mark.skipif(not PUBLIC, reason="CLEARANCE_REQIF_EXAMPLES names no folder")
def test_public_files_are_read_or_refused_with_a_sentence() -> None:
    read = 0
    for file in sorted(Path(PUBLIC).rglob("*.reqif")):
        try:
            found, _ = reqif.read(file.read_bytes())
        except CannotRead:
            continue
        else:
            assert all(one.id and one.text for one in found)
            read += 1
    assert read


@pytest.mark.parametrize("separator", [",", ";"])
def test_a_csv_file_with_other_columns(separator: str) -> None:
    lines = ["ID,Text,Owner", 'A-1,"Keep ""5 m"", always\r\nand ever",Ada', ",,", "A-2,,Bob", "A-3, x ,"]
    text = "\ufeff" + "\r\n".join(lines).replace(",", separator).replace('m""' + separator, 'm"",')
    found, skipped = table.read(text.encode())
    assert found == [Read("A-1", 'Keep "5 m", always\r\nand ever', {"Owner": "Ada"}), Read("A-3", "x", {})]
    assert skipped == 1


@pytest.mark.parametrize(
    ("content", "statement"),
    [
        (b"a,b\n1,2\n", "no column for the id: the header has a, b; it needs 'id'"),
        (b"id,b\n1,2\n", "no column for the text"),
        (b"", "the header has nothing"),
        (b"id,text\n1\n", "row 2 has 1 columns, the header has 2"),
        (b'id,text\n1,"open', "line 2 is not readable as CSV"),
        (b"id,text\n1,\xe9\n", "is not UTF-8 text (byte 10): save it as CSV UTF-8"),
        (b"id,text\n1,a\0b\n", "null characters"),
        (b"id,text\n1,\n", "no row with a text"),
        (b"id,text\n1," + b"x" * 200_000 + b"\n", "field larger than field limit"),
    ],
)
def test_a_file_that_is_no_acceptable_csv_is_refused_with_a_sentence(content: bytes, statement: str) -> None:
    with pytest.raises(CannotRead, match=r".*") as refused:
        table.read(content)
    assert statement in str(refused.value)


def test_columns_may_be_named() -> None:
    found, _ = table.read(b"id,key,words,text\n1,K,W,T\n", "key", "words")
    assert found == [Read("K", "W", {"id": "1", "text": "T"})]


def test_columns_of_the_same_name_are_numbered() -> None:
    found, _ = table.read(b"id;text;Note;;Note;text\n1;T;first;lost;second;other\n")
    assert found == [Read("1", "T", {"Note": "first", "Note (2)": "second", "text (2)": "other"})]
    found, _ = table.read(b"id,text,Note,Note\n1,T,first,second\n", text_name="Note (2)")
    assert found == [Read("1", "second", {"text": "T", "Note": "first"})]


def test_an_export_states_the_runs_that_it_does_not_list_and_keeps_columns_of_any_name() -> None:
    row = RequirementRow(
        id="R1", text="t", status="no evidence", sentence="s", registered=True, file="doc7", changed=None,
        attributes={"status": "obsolete", "status (file)": "y", "file": "x", "owner": "ada"},
        changed_by=None, etag="", runs=[], total=2345, unlisted=2345, removed=0, sweeps=0,
    )  # fmt: skip
    (line,) = csv.DictReader(io.StringIO(b"".join(sheet.requirements([row])).decode()))
    assert (line["status"], line["status (file)"]) == (row.status, "obsolete")
    assert line["status (file) (file)"] == "y"
    assert (line["file"], line["file (file)"], line["owner"]) == ("doc7", "x", "ada")
    *_, last = csv.DictReader(io.StringIO(b"".join(sheet.matrix([row])).decode()))
    assert (last["requirement"], last["run"], last["why"].split()[0]) == ("R1", "", "2345")


def test_an_apostrophe_is_a_mark_in_our_own_export_only() -> None:
    given = {"'-a": "'@b", "-c": "=d", "e": "'quoted'"}
    row = RequirementRow(
        id="=R1", text="'-mode' shall hold", status="no evidence", sentence="", registered=True, file=None,
        attributes=given, changed=None, changed_by=None, etag="", runs=[], total=0, unlisted=0, removed=0, sweeps=0,
    )  # fmt: skip
    exported = b"".join(sheet.requirements([row]))
    for content in (exported, exported.replace(b",", b";")):
        ((one,), _) = table.read(content)
        assert (one.id, one.text) == (row.id, row.text)
        assert given.items() <= one.attributes.items()
    found, _ = table.read(b"id,text,'-n\n'=R1,'-mode' shall hold,'@x\n")
    assert found == [Read("'=R1", "'-mode' shall hold", {"'-n": "'@x"})]


def test_an_export_has_columns_for_the_most_frequent_attributes_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files may name any number of attributes, and every row of a CSV file has every column."""
    monkeypatch.setattr(sheet, "MOST_COLUMNS", 2)
    given = [{"b": "1", "a": "2", "x": "=3"}, {"b": "4", "y": "5"}, {"a": "6"}]
    rows = [
        RequirementRow(
            id=f"R{i}", text="t", status="no evidence", sentence="", registered=True, file=None, attributes=attributes,
            changed=None, changed_by=None, etag="", runs=[], total=0, unlisted=0, removed=0, sweeps=0,
        )
        for i, attributes in enumerate(given)
    ]  # fmt: skip
    lines = list(csv.reader(io.StringIO(b"".join(sheet.requirements(rows)).decode())))
    assert lines[0][5:] == ["a", "b", "other attributes"]
    assert [line[5:] for line in lines[1:]] == [["2", "1", "x: =3"], ["", "4", "y: 5"], ["6", "", ""]]
    found, _ = table.read(b"".join(sheet.requirements(rows)))
    assert found[0].attributes["other attributes"] == "x: =3"
