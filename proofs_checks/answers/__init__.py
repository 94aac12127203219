"""The companion's statements about certified answers: one module a topic, its checks beside it in ``checks``."""
