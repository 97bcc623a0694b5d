# A ball falls on a floor and bounces; run it headless with godot3-server --path clients/godot.
# RINGDOWN_PORT and RINGDOWN_OBJECT name another daemon and object.
extends Spatial

const Ringdown = preload("res://ringdown.gd")
const RingingBody = preload("res://ringing_body.gd")


func _ready() -> void:
	var floor_body := StaticBody.new()
	var plane := CollisionShape.new()
	plane.shape = PlaneShape.new()
	floor_body.add_child(plane)
	add_child(floor_body)

	var ball := RingingBody.new()
	var sphere := CollisionShape.new()
	sphere.shape = SphereShape.new()
	sphere.shape.radius = 0.05
	ball.add_child(sphere)
	ball.mass = 0.02
	ball.translation = Vector3(0, 0.25, 0)
	ball.physics_material_override = PhysicsMaterial.new()
	ball.physics_material_override.bounce = 0.6
	ball.object = _setting("RINGDOWN_OBJECT", "bell")
	ball.ringdown = Ringdown.new(int(_setting("RINGDOWN_PORT", "7770")))
	add_child(ball)
	yield(get_tree().create_timer(3.0), "timeout")
	get_tree().quit()


func _setting(name: String, fallback: String) -> String:
	return OS.get_environment(name) if OS.has_environment(name) else fallback
