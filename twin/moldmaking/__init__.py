"""Mold machining from an STL file: roughing, semi-finishing of rest material, finishing, and their NC programs."""

from twin.moldmaking.load import load_mold, mold_from_dict
from twin.moldmaking.model import MoldJob
from twin.moldmaking.result import Mold, mold
from twin.moldmaking.stages import STAGES, MoldPlan, Stage

__all__ = ["STAGES", "Mold", "MoldJob", "MoldPlan", "Stage", "load_mold", "mold", "mold_from_dict"]
