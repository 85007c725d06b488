"""Force samples in a run's file: packed, one message each as earlier versions wrote them, and per revolution."""
