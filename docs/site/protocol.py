"""The pages of the protocol: one for each proto, from protoc's descriptors with their comments."""

from __future__ import annotations

import functools
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comments import escaped, markdown as prose
from google.protobuf import descriptor_pb2

PROJECT = Path(__file__).resolve().parents[2]
PROTOS = PROJECT / "proto"
FILES = [
    str(path.relative_to(PROJECT))
    for folder in ["v1", "file/v1"]
    for path in sorted((PROTOS / "ballpiston" / folder).glob("*.proto"))
]
Field = descriptor_pb2.FieldDescriptorProto
_SYNTAX = (12,)  # the path of the line before which the file's own comment stands
_SCALARS = {number: name[5:].lower() for name, number in Field.Type.items()}


@functools.cache
def _files() -> dict[str, Any]:
    with tempfile.NamedTemporaryFile() as out:
        names = [name.removeprefix("proto/") for name in FILES]
        flags = [f"-I{PROTOS}", "--include_source_info", f"--descriptor_set_out={out.name}"]
        subprocess.run(["protoc", *flags, *names], check=True)
        descriptors = descriptor_pb2.FileDescriptorSet.FromString(Path(out.name).read_bytes())
    return {f"proto/{file.name}": file for file in descriptors.file}


@dataclass
class Type:
    """A message or an enum of a file, with its path in the file's descriptor."""

    name: str  # with the names of the messages that it is nested in
    descriptor: Any
    path: tuple[int, ...]


def _types(file: Any) -> Iterator[Type]:
    """The messages and enums of a file, each message before those that are nested in it."""
    for index, message in enumerate(file.message_type):
        yield from _with_nested(Type(message.name, message, (4, index)))
    for index, enum in enumerate(file.enum_type):
        yield Type(enum.name, enum, (5, index))


def _with_nested(type: Type) -> Iterator[Type]:
    yield type
    for index, enum in enumerate(type.descriptor.enum_type):
        yield Type(f"{type.name}.{enum.name}", enum, (*type.path, 4, index))
    for index, message in enumerate(type.descriptor.nested_type):
        if not message.options.map_entry:
            child = Type(f"{type.name}.{message.name}", message, (*type.path, 3, index))
            yield from _with_nested(child)


@functools.cache
def _places() -> dict[str, str]:
    """By the full name of a type, its place: a proto and the anchor of a heading."""
    return {
        f".{file.package}.{type.name}": f"{name}#{type.name.lower().replace('.', '')}"
        for name, file in _files().items()
        for type in _types(file)
    }


class Page:
    """The page of one proto. A path is that of a part in the proto's descriptor."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._file = _files()[name]
        self._locations = {tuple(p.path): p for p in self._file.source_code_info.location}

    def _comment(self, path: tuple[int, ...]) -> list[str]:
        place = self._locations.get(path)
        text = (place.leading_comments or place.trailing_comments) if place else ""
        return [line.removeprefix(" ") for line in text.splitlines()]

    def _in_a_cell(self, path: tuple[int, ...]) -> str:
        return escaped(" ".join(line.strip() for line in self._comment(path)))

    def _link(self, full_name: str) -> str:
        shown = full_name.removeprefix(f".{self._file.package}.").removeprefix(".")
        target = _places().get(full_name)
        if target is None:
            return f"`{shown}`"
        return f"[{shown}]({'../' * self._name.count('/')}{target})"

    def _type(self, field: Any, entries: dict[str, Any]) -> str:
        entry = entries.get(field.type_name)
        if entry is not None:
            key, value = entry.field
            return f"map of {self._type(key, {})} to {self._type(value, {})}"
        shown = self._link(field.type_name) if field.type_name else _SCALARS[field.type]
        repeated = "repeated " if field.label == Field.LABEL_REPEATED else ""
        return f"{repeated}{'optional ' if field.proto3_optional else ''}{shown}"

    def _rows(self, type: Type) -> list[str]:
        if isinstance(type.descriptor, descriptor_pb2.EnumDescriptorProto):
            lines = ["| value | number | |", "|---|--:|---|"]
            for index, value in enumerate(type.descriptor.value):
                text = self._in_a_cell((*type.path, 2, index))
                lines.append(f"| `{value.name}` | {value.number} | {text} |")
            return lines
        full = f".{self._file.package}.{type.name}"
        maps = [nested for nested in type.descriptor.nested_type if nested.options.map_entry]
        entries = {f"{full}.{entry.name}": entry for entry in maps}
        lines = ["| field | number | type | |", "|---|--:|---|---|"]
        for index, field in enumerate(type.descriptor.field):
            kind, text = self._type(field, entries), self._in_a_cell((*type.path, 2, index))
            lines.append(f"| `{field.name}` | {field.number} | {kind} | {text} |")
        return lines if type.descriptor.field else []

    def _service(self, index: int, service: Any) -> Iterator[str]:
        yield f"## {service.name}\n"
        yield prose(self._comment((6, index))) + "\n"
        for number, method in enumerate(service.method):
            yield f"### {method.name}\n"
            stream = "a stream of " if method.server_streaming else ""
            yield f"`POST /{self._file.package}.{service.name}/{method.name}`\n"
            yield f"{self._link(method.input_type)} → {stream}{self._link(method.output_type)}\n"
            yield prose(self._comment((6, index, 2, number))) + "\n"

    def markdown(self) -> str:
        out = [f"# {Path(self._name).name}\n", prose(self._comment(_SYNTAX)) + "\n"]
        for index, service in enumerate(self._file.service):
            out += self._service(index, service)
        out.append("## Messages\n")
        for type in _types(self._file):
            out += [f"### {type.name}\n", prose(self._comment(type.path)) + "\n"]
            out += [*self._rows(type), ""]
        return "\n".join(out)


def markdown(name: str) -> str:
    return Page(name).markdown()


def contents() -> str:
    text = (Path(__file__).parent / "protocol.md").read_text()
    links = "".join(f"../../{name.removesuffix('.proto')}\n" for name in FILES)
    return f"{text}\n```{{toctree}}\n:maxdepth: 2\n\n{links}```\n"
