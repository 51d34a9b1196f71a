"""Notebooks as pages, with their stored output."""

import base64
import json
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]


def markdown(path: Path, stage: Path) -> str:
    """The notebook's cells. Writes its pictures to the staged folder of the notebook."""
    name = path.relative_to(PROJECT)
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        for output in cell["outputs"]:
            picture = stage / name.with_name(f"{name.stem}-{len(parts)}.png")
            parts.append(_shown(output, picture))
    parts.append(f"This page is the notebook {{download}}`{name.name}`.")
    return "\n\n".join(parts) + "\n"


def _shown(output: dict[str, Any], picture: Path) -> str:
    if output["output_type"] == "stream":
        return f"```\n{''.join(output['text'])}```"
    data = output["data"]
    if "image/png" in data:
        picture.parent.mkdir(parents=True, exist_ok=True)
        picture.write_bytes(base64.b64decode("".join(data["image/png"])))
        return f"![Figure]({picture.name})"
    if "text/html" in data:
        return f"<div class='output'>{''.join(data['text/html'])}</div>"
    return f"```\n{''.join(data['text/plain'])}\n```"
