"""The checks of the statements about certified answers."""
