"""A sweep: the mean free time of ball and piston at several delta, beside the closed form."""

import ballpiston

# The private server, which is started if it does not run. For another one: connect("host:port").
client = ballpiston.connect()

job = client.submit(
    "equilibrium",
    rho=0.5296,
    delta=[0.2, 0.1, 0.05],
    collisions=1e5,  # at each delta
    model="billiard",  # the default, "auto", would answer with the closed form
    seed=7,
)
print(job.name)  # client.job(NAME) finds the job again, also from another program

result = job.watch()  # shows a bar; Ctrl-C leaves the job running
name = "mean_free_time_ball_piston"
print("delta    measured   error     exact      z")
for delta, value, error, exact, z in zip(
    result.parameters["delta"],
    result[name],
    result.error(name),  # one standard error
    result.exact(name),
    result.z_score(name),
):
    print(f"{delta:5.3f}  {value:10.3f}  {error:6.3f}  {exact:8.3f}  {z:+5.2f}")

result.save("sweep.json")  # ballpiston.load("sweep.json") reads it again, without a server
