"""Settings for the whole suite."""

from hypothesis import settings

# kernels compile during the first examples; machines differ in speed
settings.register_profile("steady", deadline=None)
settings.load_profile("steady")
