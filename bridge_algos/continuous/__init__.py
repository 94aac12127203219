"""What needs torch (and, later, MuJoCo): nothing outside this room imports either."""
