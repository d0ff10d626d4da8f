"""Names in comments that the code does not have, and sources without a comment at their top.

In `backticks` a comment may name
  - what its paragraph mentions: the code between two blank lines or comments that follows the comment,
    or that the comment stands in. Parameters and body of a function are part of its paragraph, so a
    comment above it can name its parameters, and none of another function;
  - what its file declares outside parameters and bodies of functions, types, functions and constants
    of the headers that the file includes, and members declared there beside a type that is mentioned;
  - arguments of a call that the comment itself writes out, as in visit(i, distance);
  - files of the tree, options and verbs of the program, keys of the JSON schemas, namespace std.
A comment that a blank line follows may name whatever its file mentions. Without backticks, a
function() or Type::member must exist somewhere in the tree.
"""

import re

FOLDERS = ("src", "cuda", "apps", "python", "integrations", "tests", "bench")
SUFFIXES = {".hpp", ".cuh", ".h", ".cpp", ".cu"}

LEXEME = re.compile(
    r"(?P<comment>//[^\n]*|/\*.*?\*/)"
    r'|^[ \t]*#[ \t]*include[ \t]*["<](?P<include>[^">]+)[">]'
    r'|R"(?P<mark>[^()\s]*)\((?P<raw>.*?)\)(?P=mark)"'
    r'|"(?P<text>(?:\\.|[^"\\\n])*)"'
    r"|\b\d(?:[\w.]|'\w)*|'(?:\\.|[^'\\\n])+'",
    re.S | re.M,
)
TYPE = re.compile(r"\b(?:struct|class|using)\s+(?:alignas\([^)]*\)\s*)?([A-Z]\w*)")
NAME_OF_CALL = re.compile(r"([A-Za-z_]\w*)(?:<[^;{}()]*>)?\s*\(")
WORD = re.compile(r"[A-Za-z_]\w*")
# The beginning of a declaration that is no part of it, and what it looks like where its braces hold
# declarations.
PREFIX = re.compile(r"\btemplate\s*<(?:[^<>]|<(?:[^<>]|<[^<>]*>)*>)*>|\b(?:public|private|protected):"
                    r"|\b(?:alignas|__align__)\(\)|#(?:\\\n|[^\n])*")  # fmt: skip
DIRECTIVE = re.compile(r"^[ \t]*#(?:\\\n|[^\n])*", re.M)
SCOPE = re.compile(r"\s*(?:inline\s+)?(?:namespace|struct|class|union|enum)\b[^()=]*$")
BLANK_LINE = re.compile(r"\n\s*\n")
FILE = re.compile(r"[\w./*-]+\.(?:hpp|cuh|h|cpp|cu|py|md|json|csv|sh|cmake|txt|js|css|html)")
QUOTED = re.compile(r"`([^`]*)`")
OPTION = re.compile(r"--[a-z][\w-]*")
# What is looked for elsewhere or nowhere: options, names of namespace std, numbers, an index.
FOREIGN = re.compile(r"--[a-z][\w-]*|std::\w+(?:::\w+)*|\b\d[\w.]*|\[[a-z]\]|\n\s*//")
CALL = re.compile(r"\b([A-Za-z_]\w*)\(([^()]+)\)")
NAMED = re.compile(r"(?<![\w:.>])((?:\w+::)+[A-Za-z_]\w*|[A-Za-z_]\w*(?=\(\)))(\(\))?")


def blank(text):
    return re.sub(r"[^\n]", " ", text)


class Source:
    def __init__(self, text):
        self.text = text
        self.comments = []  # begin and end; lines below each other that begin with // are one
        self.includes = []
        self.literals = set()  # names of values, and what code in other languages mentions
        self.functions = set()
        self.code = LEXEME.sub(self._blank, text)
        self.functions |= set(NAME_OF_CALL.findall(self.code))
        self.words = set(WORD.findall(self.code)) | self.literals
        bodies = self._bodies()
        flat = list(self.code)
        for begin, end in self.comments:
            if self._alone(begin):
                flat[begin:end] = "\n" * (end - begin)  # it parts paragraphs
        for begin, end in bodies:
            flat[begin:end] = self.code[begin:end].replace("\n", " ")
        gaps = [(0, 0), *(gap.span() for gap in BLANK_LINE.finditer("".join(flat))), (len(text), 0)]
        self.paragraphs = [(before[1], after[0]) for before, after in zip(gaps, gaps[1:])]
        for begin, end in bodies:
            flat[begin:end] = " " * (end - begin)
        outside = "".join(flat) + " ".join(DIRECTIVE.findall(self.code))
        self.declared = set(WORD.findall(outside)) | self.literals
        self.types = set(TYPE.findall(self.code))
        self.names = {name for name in self.declared
                      if name in self.functions or re.search("[A-Z]", name)}  # fmt: skip

    def _alone(self, begin):
        return not self.text[self.text.rfind("\n", 0, begin) + 1 : begin].strip()

    def _blank(self, match):
        begin, end = match.span()
        if match["comment"]:
            last = self.comments[-1] if self.comments else (0, 0)
            if self._alone(begin) and re.fullmatch(r"\n[ \t]*", self.text[last[1] : begin]):
                self.comments[-1] = (last[0], end)
            else:
                self.comments.append((begin, end))
        elif match["include"]:
            self.includes.append(match["include"])
        elif match["raw"]:
            self.literals |= set(WORD.findall(match["raw"]))
            self.functions |= set(NAME_OF_CALL.findall(match["raw"]))
        elif match["text"] and WORD.fullmatch(match["text"]):
            self.literals.add(match["text"])
        return blank(match[0])

    def _bodies(self):
        """The spans in parentheses, and in the braces of functions and values."""
        bodies, depth, begin, head = [], 0, 0, ""
        for match in re.finditer(r"[{}();]|[^{}();]+", self.code):
            piece = match[0]
            if depth:
                depth += (piece in "({") - (piece in ")}")
                if not depth:
                    bodies.append((begin, match.end()))
                    goes_on = piece == ")" or re.match(r"\s*[,;{=]", self.code[match.end() :])
                    head = head + "()" if goes_on else ""
            elif piece == "(" or piece == "{" and not SCOPE.match(PREFIX.sub("", head)):
                depth, begin = 1, match.start()
            else:
                head = "" if piece in "{};" else head + piece
        return bodies

    def about(self, begin, end):
        """The words that the comment is about."""
        for first, last in self.paragraphs:
            if first <= begin < last and self.code[first:begin].strip():
                return set(WORD.findall(self.code[first:last]))  # in it
            if first >= end - 1 and self.code[first:last].strip():
                if BLANK_LINE.match(self.text, end) or "#" in self.text[end:first]:
                    break
                return set(WORD.findall(self.code[first:last]))  # above it
        return self.words


class Tree:
    def __init__(self, root):
        self.sources = {
            path.relative_to(root).as_posix(): Source(path.read_text())
            for folder in FOLDERS
            for path in sorted((root / folder).rglob("*"))
            if path.suffix in SUFFIXES
        }
        sources = self.sources.values()
        self.functions = set().union(*(source.functions for source in sources))
        self.words = set().union(*(source.words for source in sources))
        self.literals = set().union(*(source.literals for source in sources))
        code = "".join(LEXEME.sub(lambda m: "" if m["comment"] else m[0], s.text) for s in sources)
        self.options = set(OPTION.findall(code))
        schemas = "".join(path.read_text() for path in sorted((root / "docs").glob("*.schema.json")))
        self.keys = set(re.findall(r'"(\w+)"\s*:', schemas))
        kept = [path for path in root.iterdir() if path.name not in (".git", "build")]
        self.files = "".join(f"/{file.relative_to(root).as_posix()}\n"
                             for path in kept for file in [path, *path.rglob("*")])  # fmt: skip

    def headers(self, name, seen):
        """The headers of the project that the file includes, and those that they include."""
        for included in self.sources[name].includes:
            for folder in ("src/", "", "apps/", "tests/", "bench/", name.rpartition("/")[0] + "/"):
                path = folder + included
                if path in self.sources and path not in seen:
                    seen.add(path)
                    self.headers(path, seen)
        return [self.sources[path] for path in seen]

    def wrong_names(self):
        for name, source in self.sources.items():
            headers = self.headers(name, set())
            for begin, end in source.comments:
                comment = source.text[begin:end]
                line = source.text.count("\n", 0, begin) + 1
                paragraph = source.about(begin, end)
                known = paragraph.union(source.declared, *(header.names for header in headers))
                for call, arguments in CALL.findall(comment):
                    known |= set(WORD.findall(arguments)) if call in known else set()
                for match in QUOTED.finditer(comment):
                    mentioned = paragraph | set(WORD.findall(match[1]))
                    members = [header.declared for header in headers if header.types & mentioned]
                    for missing in self._missing(match[1], known.union(*members)):
                        at = line + comment.count("\n", 0, match.start())
                        yield f"{name}:{at}: no `{missing}` in what the comment is about"
                for match in NAMED.finditer(QUOTED.sub(lambda m: blank(m[0]), comment)):
                    last = match[1].rpartition("::")[2]
                    known = self.functions if match[2] else self.words
                    if last not in known and not match[1].startswith("std::"):
                        at = line + comment.count("\n", 0, match.start())
                        yield f"{name}:{at}: no {match[0]} anywhere"

    def _missing(self, quoted, known):
        if FILE.fullmatch(quoted):
            return [] if f"/{quoted}\n" in self.files else [quoted]
        known = known | self.keys | {"vdwmesh"}
        if quoted.startswith("vdwmesh "):
            known |= self.literals
        names = WORD.findall(FOREIGN.sub(" ", quoted))
        return [option for option in OPTION.findall(quoted) if option not in self.options] + [
            name for name in names if name not in known]  # fmt: skip

    def bare_sources(self):
        """Those of the library that do not begin with a comment; a long one says how it works."""
        for name, source in self.sources.items():
            if name.startswith(("src/", "cuda/", "python/", "integrations/")) and name.endswith((".cpp", ".cu")):
                begin, end = source.comments[0] if source.comments else (1, 1)
                lines = source.text.count("\n", begin, end) + 1 if begin == 0 else 0
                needed = 2 if source.text.count("\n") > 60 else 1
                if lines < needed:
                    yield f"{name}: begins with {lines} lines of comment, {needed} are needed"
