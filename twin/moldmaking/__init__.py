"""Mold machining from an STL: roughing, semi-finishing of what is left, finishing, and the programs of all three."""

from twin.moldmaking.chain import STAGES, MoldChain, Stage
from twin.moldmaking.load import load_mold, mold_from_dict
from twin.moldmaking.model import MoldJob

__all__ = ["STAGES", "MoldChain", "MoldJob", "Stage", "load_mold", "mold_from_dict"]
