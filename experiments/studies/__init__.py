"""What a figure or table computes, draws and says: one module a study, chosen by a configuration's entry ``study``."""
