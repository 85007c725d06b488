"""The job file as a JSON Schema, for editors."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from twin.job.model import JobFile

_STOCKS = ("box_mm", "cylinder_mm", "stl")


class _TomlSchema(GenerateJsonSchema):
    """TOML has no null: a key is there or not."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        if schema.get("default") is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


def job_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a job file.

    What one key says about another is not in it, but for the one stock: `load_job` checks more.
    """
    schema = JobFile.model_json_schema(schema_generator=_TomlSchema)
    schema["$defs"]["Stock"]["oneOf"] = [{"required": [key]} for key in _STOCKS]
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "title": "Job of a machining twin"}
