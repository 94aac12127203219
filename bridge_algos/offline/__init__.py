"""The offline stage: behavioural cloning, the transition estimate, and the ball of policies around the clone."""
