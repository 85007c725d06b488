"""The job file: one TOML file with the program, the stock, the tools and the resolution of a replay.

`load_job` reads one and reports every mistake in it at once, as a `twin.errors.JobError`.
"""

from twin.job.job_file import (
    RAPIDS,
    Cutting,
    Job,
    JobFile,
    Machine,
    Output,
    Program,
    RigidPart,
    Simulation,
    Tool,
    job_schema,
)
from twin.job.load import job_from_dict, job_from_text, load_job
from twin.job.stock_keys import Box, Cylinder, Stock

__all__ = [
    "RAPIDS",
    "Box",
    "Cutting",
    "Cylinder",
    "Job",
    "JobFile",
    "Machine",
    "Output",
    "Program",
    "RigidPart",
    "Simulation",
    "Stock",
    "Tool",
    "job_from_dict",
    "job_from_text",
    "job_schema",
    "load_job",
]
