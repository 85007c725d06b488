"""Mold machining from an STL: roughing, semi-finishing of what is left, finishing, and the programs of all three."""

from twin.mold.chain import STAGES, MoldChain, Stage
from twin.mold.load import load_mold, mold_from_dict
from twin.mold.model import MoldJob

__all__ = ["STAGES", "MoldChain", "MoldJob", "Stage", "load_mold", "mold_from_dict"]
